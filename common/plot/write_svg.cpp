#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "common/error.h"
#include "common/plot/figure.h"

namespace tautline::plot {
namespace {

// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

// A temporary file beside `target`, removed unless it was renamed into place.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : name_(target.string() + ".XXXXXX"), fd_(::mkostemp(name_.data(), O_CLOEXEC)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (fd_.get() >= 0 && !renamed_) ::unlink(name_.c_str());
  }
  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] off_t size() const { return ::lseek(fd_.get(), 0, SEEK_END); }
  [[nodiscard]] bool renameTo(const std::filesystem::path& target) {
    constexpr mode_t kReadableByAll = 0644;
    renamed_ =
        ::fchmod(fd_.get(), kReadableByAll) == 0 && ::rename(name_.c_str(), target.c_str()) == 0;
    return renamed_;
  }

 private:
  std::string name_;
  Descriptor fd_;
  bool renamed_{false};
};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem,
                       const std::string& remedy = {}) {
  throw InputError({.file = file.string(),
                    .line = 0,
                    .key = {},
                    .problem = problem,
                    .allowed = {},
                    .remedy = remedy},
                   ExitCode::kFailed);
}

bool writeAll(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

std::string firstLineOf(int fd) {
  std::array<char, 400> buffer{};
  const ssize_t n = ::pread(fd, buffer.data(), buffer.size(), 0);
  std::string text(buffer.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

// Runs gnuplot with these files as its standard streams. Files instead of pipes: neither side can
// block the other or be hit by SIGPIPE, however the child ends. Returns the exit code, or -errno
// when it could not be started.
int runGnuplot(int in, int out, int err) {
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_adddup2(&streams, in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&streams, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&streams, err, STDERR_FILENO);
  // -d: no start-up files of the user, so that a figure looks the same for everybody.
  std::array<char, 8> program{"gnuplot"};
  std::array<char, 3> option{"-d"};
  std::array<char*, 3> arguments{program.data(), option.data(), nullptr};
  pid_t child = 0;
  const int started =
      ::posix_spawnp(&child, program.data(), &streams, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  if (started != 0) return -started;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -errno;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

void writeSvg(const Figure& figure, const std::filesystem::path& file) {
  constexpr const char* kInstall = "apt-get install gnuplot-nox";
  const Descriptor script(::memfd_create("figure.gp", MFD_CLOEXEC));
  const Descriptor errors(::memfd_create("gnuplot.err", MFD_CLOEXEC));
  if (script.get() < 0 || errors.get() < 0 || !writeAll(script.get(), gnuplotScript(figure)) ||
      ::lseek(script.get(), 0, SEEK_SET) != 0) {
    fail(file, std::string("no memory for the figure: ") + std::strerror(errno));
  }
  TemporaryFile picture(file);
  if (picture.fd() < 0) fail(file, std::string("cannot write here: ") + std::strerror(errno));

  const int result = runGnuplot(script.get(), picture.fd(), errors.get());
  if (result == -ENOENT || result == 127)
    fail(file, "the program gnuplot, which draws the pictures, is missing", kInstall);
  if (result < 0)
    fail(file, std::string("cannot start gnuplot: ") + std::strerror(-result), kInstall);
  if (result != 0)
    fail(file, "gnuplot failed (" + std::to_string(result) + "): " + firstLineOf(errors.get()),
         kInstall);
  if (picture.size() <= 0)
    fail(file, "gnuplot drew nothing: " + firstLineOf(errors.get()), kInstall);
  if (!picture.renameTo(file))
    fail(file, std::string("cannot write here: ") + std::strerror(errno));
}

}  // namespace tautline::plot
