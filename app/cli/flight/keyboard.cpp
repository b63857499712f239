#include "app/cli/flight/keyboard.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "common/error.h"

namespace tautline::cli::flight {
namespace {

constexpr Duration kFirstStroke = std::chrono::milliseconds(700);
constexpr Duration kRepeats = std::chrono::milliseconds(150);
constexpr Duration kFastStrokes = std::chrono::milliseconds(120);
constexpr char kCtrlC = 3;
constexpr char kCtrlD = 4;
constexpr char kEscape = 27;

}  // namespace

RawTerminal::RawTerminal() {
  if (isatty(STDIN_FILENO) == 0 || tcgetattr(STDIN_FILENO, &before_) != 0) {
    throw InputError({.key = "teleop",
                      .problem = "standard input is no terminal, so there is no keyboard",
                      .remedy = "run it in a terminal, or with --script FILE"},
                     ExitCode::kUsage);
  }
  termios raw = before_;
  cfmakeraw(&raw);
  raw.c_oflag |= OPOST;  // new lines stay new lines
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() { tcsetattr(STDIN_FILENO, TCSANOW, &before_); }

std::optional<std::string> RawTerminal::read() const {
  pollfd in{STDIN_FILENO, POLLIN, 0};
  if (poll(&in, 1, 0) < 0) return errno == EINTR ? std::optional(std::string()) : std::nullopt;
  if ((in.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) return std::nullopt;
  if ((in.revents & POLLIN) == 0) return std::string();
  std::array<char, 64> keys{};
  const ssize_t count = ::read(STDIN_FILENO, keys.data(), keys.size());
  if (count <= 0) return std::nullopt;  // there was something to read, and it was the end
  return std::string(keys.data(), static_cast<std::size_t>(count));
}

void KeyboardSticks::press(char key, Time now) noexcept {
  if (key == kCtrlC || key == kCtrlD || key == kEscape) end_ = true;
  if (key == ' ') {
    const bool repeats = deadManHeld() && now - last_stroke_ < kFastStrokes;
    held_until_ = now + (repeats ? kRepeats : kFirstStroke);
    last_stroke_ = now;
    return;
  }
  if (key == 'x') rates_ = {};
  for (const StickKeys& stick : kSticks) {
    if (key != stick.up && key != stick.down) continue;
    double& rate = rates_.*stick.rate;
    rate = std::clamp(rate + (key == stick.up ? stick.step : -stick.step), -stick.most, stick.most);
  }
}

void KeyboardSticks::update(Time now) noexcept {
  if (!held_until_ || now < *held_until_) return;
  held_until_.reset();
  rates_ = {};
}

}  // namespace tautline::cli::flight
