#include "drivers/test/pty.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace tautline::testing {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "tautline_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Pty::Pty() : link_(folder_.path() / "device") { plug(); }

Pty::~Pty() { unplug(); }

void Pty::plug() {
  unplug();
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> slave{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, slave.data(), slave.size()) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  fs::create_symlink(slave.data(), link_);
}

void Pty::unplug() {
  if (master_ < 0) return;
  ::close(master_);
  master_ = -1;
  unfinished_.clear();
  fs::remove(link_);
}

void Pty::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::write(master_, bytes.data(), bytes.size());
    if (count <= 0) throw std::runtime_error("the pseudo terminal takes no more");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

std::string Pty::receive() const {
  std::string all;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = ::read(master_, buffer.data(), buffer.size());
    if (count <= 0) return all;
    all.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

std::vector<std::string> Pty::receiveLines() {
  unfinished_ += receive();
  std::vector<std::string> lines;
  for (std::size_t end = unfinished_.find('\n'); end != std::string::npos;
       end = unfinished_.find('\n')) {
    lines.push_back(unfinished_.substr(0, end));
    unfinished_.erase(0, end + 1);
  }
  return lines;
}

}  // namespace tautline::testing
