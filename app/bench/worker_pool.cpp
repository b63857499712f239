#include "app/bench/worker_pool.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <memory>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

namespace tautline::bench {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// First character of a worker's line.
constexpr char kDone = '+';
constexpr char kFailed = '-';

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// A process that runs jobs `next`, `next + stride`, … and says what came of each in a line.
class Worker {
 public:
  Worker(const PoolJob& job, std::size_t first, std::size_t stride)
      : job_(job), next_(first), stride_(stride) {
    start();
  }
  ~Worker() { finish(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  [[nodiscard]] bool done() const noexcept { return next_ >= job_.count; }
  [[nodiscard]] int descriptor() const noexcept { return input_; }

  /// Takes what the process has said.
  void listen() {
    std::array<char, 4096> buffer;
    const ssize_t count = ::read(input_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) return;
    if (count > 0) {
      text_.append(buffer.data(), static_cast<std::size_t>(count));
      for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
        const std::string said = text_.substr(1, end - 1);
        answered(text_.front() == kDone ? JobOutcome{said, {}} : JobOutcome{{}, said});
        text_.erase(0, end + 1);
      }
      return;
    }
    const int status = finish();
    if (done()) return;
    answered({{},
              WIFSIGNALED(status)
                  ? fmt::format("the process was ended by signal {}", WTERMSIG(status))
                  : fmt::format("the process ended with code {}", WEXITSTATUS(status))});
    if (!done()) start();
  }

 private:
  void answered(const JobOutcome& outcome) {
    if (job_.each) job_.each(next_, outcome);
    next_ += stride_;
  }

  void start() {
    if (done()) return;
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) fail("pipe");
    std::fflush(nullptr);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ < 0) fail("fork");
    if (process_ == 0) {
      ::close(ends[0]);
      work(ends[1], parent);
    }
    ::close(ends[1]);
    input_ = ends[0];
    text_.clear();
  }

  [[noreturn]] void work(int output, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(1);
    for (std::size_t i = next_; i < job_.count; i += stride_) {
      std::string line;
      try {
        line = kDone + oneLine(job_.run(i)) + '\n';
      } catch (const std::exception& e) {
        line = kFailed + oneLine(e.what()) + '\n';
      }
      for (std::size_t sent = 0; sent < line.size();) {
        const ssize_t count = ::write(output, line.data() + sent, line.size() - sent);
        if (count < 0 && errno != EINTR) ::_exit(1);
        sent += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
      }
    }
    ::_exit(0);
  }

  int finish() noexcept {
    if (input_ < 0) return 0;
    ::close(input_);
    input_ = -1;
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  const PoolJob& job_;
  std::size_t next_;
  std::size_t stride_;
  pid_t process_{-1};
  int input_{-1};
  std::string text_;
};

}  // namespace

void runAll(const PoolJob& job) {
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t stride =
      std::min(job.count, job.workers > 0 ? static_cast<std::size_t>(job.workers) : processors);
  std::vector<std::unique_ptr<Worker>> workers;
  for (std::size_t k = 0; k < stride; ++k)
    workers.push_back(std::make_unique<Worker>(job, k, stride));
  for (;;) {
    std::vector<pollfd> waiting;
    std::vector<Worker*> owners;
    for (const auto& worker : workers) {
      if (worker->descriptor() < 0) continue;
      waiting.push_back({worker->descriptor(), POLLIN, 0});
      owners.push_back(worker.get());
    }
    if (waiting.empty()) return;
    if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) fail("poll");
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting[i].revents != 0) owners[i]->listen();
    }
  }
}

}  // namespace tautline::bench
