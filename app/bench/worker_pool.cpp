#include "app/bench/worker_pool.h"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "app/bench/case_report.h"

namespace tautline::bench {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// A process that flies cases `next`, `next + stride`, … and says what came of each in a line.
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

  /// Takes what the process has said; calls `take(index, result)` for each case.
  template <class Take>
  void listen(const Take& take) {
    std::array<char, 4096> buffer;
    const ssize_t count = ::read(input_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) return;
    if (count > 0) {
      text_.append(buffer.data(), static_cast<std::size_t>(count));
      for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
        answered(caseFromJson(text_.substr(0, end)), take);
        text_.erase(0, end + 1);
      }
      return;
    }
    const int status = finish();
    if (done()) return;
    CaseResult dead;
    dead.name = job_.name(next_);
    dead.failure = WIFSIGNALED(status)
                       ? fmt::format("the process was ended by signal {}", WTERMSIG(status))
                       : fmt::format("the process ended with code {}", WEXITSTATUS(status));
    answered(dead, take);
    if (!done()) start();
  }

 private:
  template <class Take>
  void answered(const CaseResult& result, const Take& take) {
    take(next_, result);
    next_ += stride_;
  }

  void start() {
    if (done()) return;
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) fail("pipe");
    std::fflush(nullptr);
    process_ = ::fork();
    if (process_ < 0) fail("fork");
    if (process_ == 0) {
      ::close(ends[0]);
      work(ends[1]);
    }
    ::close(ends[1]);
    input_ = ends[0];
    text_.clear();
  }

  [[noreturn]] void work(int output) {
    for (std::size_t i = next_; i < job_.count; i += stride_) {
      CaseResult result;
      try {
        result = job_.fly(i);
      } catch (const std::exception& e) {
        result.name = job_.name(i);
        result.failure = e.what();
      }
      const std::string line = toJson(result) + "\n";
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

std::vector<CaseResult> flyAll(const PoolJob& job) {
  std::vector<CaseResult> results(job.count);
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t stride =
      std::min(job.count, job.workers > 0 ? static_cast<std::size_t>(job.workers) : processors);
  std::vector<std::unique_ptr<Worker>> workers;
  for (std::size_t k = 0; k < stride; ++k)
    workers.push_back(std::make_unique<Worker>(job, k, stride));
  const auto take = [&](std::size_t index, const CaseResult& result) {
    results[index] = result;
    if (job.each_result) job.each_result(result);
  };
  for (;;) {
    std::vector<pollfd> waiting;
    std::vector<Worker*> owners;
    for (const auto& worker : workers) {
      if (worker->descriptor() < 0) continue;
      waiting.push_back({worker->descriptor(), POLLIN, 0});
      owners.push_back(worker.get());
    }
    if (waiting.empty()) return results;
    if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) fail("poll");
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting[i].revents != 0) owners[i]->listen(take);
    }
  }
}

}  // namespace tautline::bench
