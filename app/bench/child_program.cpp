#include "app/bench/child_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/loop_timer.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

constexpr Duration kPatience = std::chrono::seconds(2);  // with a program that was asked to end
constexpr Duration kLook = std::chrono::milliseconds(5);

/// This process's environment without the service manager's socket, which is not the program's.
std::vector<std::string> environmentWith(const fs::path& runtime_folder) {
  constexpr std::string_view kRuntime = "XDG_RUNTIME_DIR=";
  constexpr std::string_view kNotify = "NOTIFY_SOCKET=";
  std::vector<std::string> variables{std::string(kRuntime) + runtime_folder.string()};
  for (char** v = environ; *v != nullptr; ++v) {
    const std::string_view text(*v);
    if (!text.starts_with(kRuntime) && !text.starts_with(kNotify)) variables.emplace_back(text);
  }
  return variables;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// In the new process; only what is allowed between fork and exec.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment,
                         const char* output, pid_t parent) noexcept {
  constexpr int kCannot = 127;  // as a shell has it
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kCannot);
  const int in = ::open("/dev/null", O_RDONLY);
  const int out = ::open(output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (in < 0 || out < 0) ::_exit(kCannot);
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(out, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);  // sockets and pipes of this process are not its own
  ::execve(program, arguments, environment);
  ::_exit(kCannot);
}

}  // namespace

fs::path programBeside(const std::string& name) {
  const fs::path path = fs::read_symlink("/proc/self/exe").parent_path() / name;
  if (fs::exists(path)) return path;
  throw InputError({.key = path.string(),
                    .problem = "is not there",
                    .remedy = "build it: cmake --build --preset release --target " + name},
                   ExitCode::kFailed);
}

ChildProgram::ChildProgram(const fs::path& program, const std::vector<std::string>& arguments,
                           const fs::path& folder)
    : name_(program.filename().string()), output_(folder / (name_ + ".txt")) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environmentWith(folder);
  const std::vector<char*> argv = pointersTo(words);
  const std::vector<char*> environment = pointersTo(variables);
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (process_ == 0)
    become(program.c_str(), argv.data(), environment.data(), output_.c_str(), parent);
}

ChildProgram::~ChildProgram() { static_cast<void>(end()); }

std::string ChildProgram::ended() { return reap(WNOHANG) ? outcome() : std::string(); }

std::string ChildProgram::end() {
  if (running_) {
    send(SIGTERM);
    for (const Time until = monotonicNow() + kPatience; !reap(WNOHANG) && monotonicNow() < until;)
      sleepUntil(monotonicNow() + kLook);
    if (running_) send(SIGKILL);
    static_cast<void>(reap(0));
  }
  return WIFEXITED(status_) && WEXITSTATUS(status_) == 0 ? std::string() : outcome();
}

std::string ChildProgram::lastLine() const {
  std::string last;
  std::ifstream in(output_);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

void ChildProgram::standStill(Duration duration) noexcept {
  send(SIGSTOP);
  sleepUntil(monotonicNow() + duration);
  send(SIGCONT);
}

void ChildProgram::send(int signal) noexcept {
  if (running_) ::kill(process_, signal);
}

/// Whether it has ended.
bool ChildProgram::reap(int options) noexcept {
  while (running_) {
    const pid_t got = ::waitpid(process_, &status_, options);
    if (got == 0) return false;
    if (got < 0 && errno == EINTR) continue;
    running_ = false;
  }
  return true;
}

std::string ChildProgram::outcome() const {
  const std::string how = WIFSIGNALED(status_)
                              ? fmt::format("was ended by signal {}", WTERMSIG(status_))
                              : fmt::format("ended with code {}", WEXITSTATUS(status_));
  return fmt::format("{} {}: {}", name_, how, lastLine());
}

}  // namespace tautline::bench
