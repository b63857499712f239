#include "app/cli/operator_identity.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string_view>

#include "common/clock.h"
#include "common/error.h"

namespace tautline::cli {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::string userAtHost() {
  const passwd* user = getpwuid(getuid());
  char host[64] = "?";
  gethostname(host, sizeof host - 1);
  return std::string(user != nullptr ? user->pw_name : "user") + "@" + host;
}

/// Only letters, digits, '-' and '_' stay: it becomes part of a file's name.
std::string fileSafe(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '_');
  return text;
}

std::filesystem::path fileOf(const std::string& own_name) {
  const std::string suffix = own_name.empty() ? "" : "-" + fileSafe(own_name);
  const std::string run = variable("XDG_RUNTIME_DIR");
  if (!run.empty() && std::filesystem::is_directory(run))
    return std::filesystem::path(run) / ("tautline-operator" + suffix);
  return "/tmp/tautline-operator-" + std::to_string(getuid()) + suffix;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem) {
  throw InputError({.file = file.string(),
                    .problem = problem,
                    .remedy = "remove it, or set XDG_RUNTIME_DIR to a folder of your own"},
                   ExitCode::kFailed);
}

std::int64_t newSession() {
  std::random_device device;
  const auto number = (static_cast<std::uint64_t>(device()) << 32) | device();
  return static_cast<std::int64_t>(std::max<std::uint64_t>(number >> 1, 1));
}

/// The number in `file`, written there first if the file is new. A file of somebody else's in a
/// shared folder is not followed and not believed.
std::int64_t sessionIn(const std::filesystem::path& file) {
  const int fd = open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd < 0) fail(file, std::string("cannot be opened: ") + std::strerror(errno));
  struct stat info {};
  std::int64_t session = 0;
  const bool ours = fstat(fd, &info) == 0 && info.st_uid == getuid() && (info.st_mode & 0077) == 0;
  bool good = ours && read(fd, &session, sizeof session) == sizeof session && session > 0;
  if (ours && !good) {
    session = newSession();
    good = pwrite(fd, &session, sizeof session, 0) == sizeof session;
  }
  close(fd);
  if (!good) fail(file, ours ? "cannot be written" : "is not yours alone");
  return session;
}

}  // namespace

OperatorIdentity::OperatorIdentity() {
  const std::string own_name = variable("TAUTLINE_OPERATOR");
  name_ = own_name.empty() ? userAtHost() : own_name;
  session_ = sessionIn(fileOf(own_name));
}

std::int64_t OperatorIdentity::nextSequence() noexcept {
  last_ = std::max(last_ + 1, toMicroseconds(monotonicNow() + unixOffset()));
  return last_;
}

}  // namespace tautline::cli
