#include "app/cli/spy/terminal.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "common/error.h"

namespace tautline::cli {
namespace {

struct KeySequence {
  std::string_view bytes;
  int key;
};
constexpr std::array<KeySequence, 14> kSequences{{{"\x1b[A", key::kUp},
                                                  {"\x1b[B", key::kDown},
                                                  {"\x1b[C", key::kRight},
                                                  {"\x1b[D", key::kLeft},
                                                  {"\x1bOA", key::kUp},
                                                  {"\x1bOB", key::kDown},
                                                  {"\x1bOC", key::kRight},
                                                  {"\x1bOD", key::kLeft},
                                                  {"\x1b[5~", key::kPageUp},
                                                  {"\x1b[6~", key::kPageDown},
                                                  {"\r", key::kEnter},
                                                  {"\n", key::kEnter},
                                                  {"\x7f", key::kBackspace},
                                                  {"\b", key::kBackspace}}};

void writeAll(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written <= 0) return;  // a terminal that is gone is found out by readKey()
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

constexpr int kSequenceMs = 25;
constexpr std::string_view kOtherScreen = "\x1b[?1049h\x1b[?25l";
constexpr std::string_view kFirstScreen = "\x1b[?25h\x1b[?1049l";

}  // namespace

Terminal::Terminal() {
  if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before_) != 0 ||
      ::isatty(STDOUT_FILENO) == 0) {
    throw InputError({.problem = "stdin and stdout are no terminal",
                      .remedy = "use --once or --json where there is none"},
                     ExitCode::kUsage);
  }
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;  // the shell would come back to this screen
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  writeAll(kOtherScreen);
}

Terminal::~Terminal() {
  writeAll(kFirstScreen);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

Terminal::Size Terminal::size() const {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 || size.ws_col == 0)
    return {};
  return {size.ws_row, size.ws_col};
}

bool Terminal::takeTyped(int wait_ms) {
  std::array<char, 256> bytes{};
  pollfd in{STDIN_FILENO, POLLIN, 0};
  if (::poll(&in, 1, wait_ms) <= 0) return true;
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) return false;
  typed_.append(bytes.data(), static_cast<std::size_t>(count));
  return true;
}

int Terminal::readKey() {
  // A sequence may come in two pieces over a network; without its second one it is the key Escape.
  if (!takeTyped(0) || (typed_ == "\x1b" && !takeTyped(kSequenceMs))) return key::kHangUp;
  if (typed_.empty()) return key::kNone;
  const auto known = std::find_if(kSequences.begin(), kSequences.end(), [&](const KeySequence& s) {
    return typed_.starts_with(s.bytes);
  });
  if (known != kSequences.end()) {
    typed_.erase(0, known->bytes.size());
    return known->key;
  }
  const int first = static_cast<unsigned char>(typed_.front());
  const bool other_sequence = first == 0x1b && typed_.size() > 1 && typed_[1] == '[';
  typed_.erase(0, other_sequence ? typed_.size() : 1);
  if (other_sequence) return key::kNone;
  return first == 0x1b ? key::kEscape : first;
}

void Terminal::show(const std::vector<ScreenLine>& lines) {
  const Size screen = size();
  std::string out = "\x1b[H";
  for (std::size_t i = 0; i < std::min(lines.size(), screen.rows); ++i) {
    std::string text = lines[i].text.substr(0, screen.columns);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    if (i > 0) out += "\r\n";
    if (lines[i].highlighted) {
      text.resize(screen.columns, ' ');
      out += "\x1b[7m" + text + "\x1b[0m";
    } else {
      out += text + (text.size() < screen.columns ? "\x1b[K" : "");
    }
  }
  writeAll(out + (lines.size() < screen.rows ? "\x1b[J" : ""));
}

}  // namespace tautline::cli
