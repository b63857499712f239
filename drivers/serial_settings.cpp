#include "drivers/serial_settings.h"

#include <asm/termbits.h>
#include <linux/serial.h>
#include <sys/ioctl.h>

#include <array>

namespace tautline {
namespace {

constexpr tcflag_t kInputRate = static_cast<tcflag_t>(CBAUD) << static_cast<tcflag_t>(IBSHIFT);
constexpr tcflag_t kFrame = CSIZE | PARENB | PARODD | CSTOPB | CRTSCTS;
constexpr tcflag_t kTranslation =
    IGNBRK | BRKINT | PARMRK | INPCK | ISTRIP | INLCR | IGNCR | ICRNL | IXON | IXOFF | IXANY;
constexpr tcflag_t kLineEditing = ECHO | ECHONL | ICANON | ISIG | IEXTEN;

// Rates with a code of their own; every driver knows these, and other programs can show them.
struct StandardRate {
  int baud;
  tcflag_t code;
};
constexpr std::array kStandardRates{
    StandardRate{9600, B9600},       StandardRate{19200, B19200},
    StandardRate{38400, B38400},     StandardRate{57600, B57600},
    StandardRate{115200, B115200},   StandardRate{230400, B230400},
    StandardRate{460800, B460800},   StandardRate{500000, B500000},
    StandardRate{921600, B921600},   StandardRate{1000000, B1000000},
    StandardRate{2000000, B2000000}, StandardRate{4000000, B4000000},
};

tcflag_t rateCode(int baud) noexcept {
  for (const StandardRate& rate : kStandardRates) {
    if (rate.baud == baud) return rate.code;
  }
  return BOTHER;  // c_ospeed tells
}

}  // namespace

bool setSerialSettings(int fd, int baud) noexcept {
  termios2 settings{};
  if (ioctl(fd, TCGETS2, &settings) != 0) return false;
  settings.c_iflag &= ~kTranslation;
  settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  settings.c_lflag &= ~kLineEditing;
  settings.c_cflag &= ~(kFrame | static_cast<tcflag_t>(CBAUD) | kInputRate);
  settings.c_cflag |= CS8 | CREAD | CLOCAL | rateCode(baud);  // input rate 0: as the output's
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  return ioctl(fd, TCSETS2, &settings) == 0;
}

bool getSerialSettings(int fd, SerialSettings& out) noexcept {
  termios2 settings{};
  if (ioctl(fd, TCGETS2, &settings) != 0) return false;
  out.raw_8n1 = (settings.c_iflag & kTranslation) == 0 && (settings.c_oflag & OPOST) == 0 &&
                (settings.c_lflag & kLineEditing) == 0 && (settings.c_cflag & kFrame) == CS8 &&
                (settings.c_cflag & CREAD) != 0;
  out.returns_at_once = settings.c_cc[VMIN] == 0 && settings.c_cc[VTIME] == 0;
  out.baud = static_cast<int>(settings.c_ospeed);
  return true;
}

bool setLowLatency(int fd) noexcept {
  serial_struct settings{};
  if (ioctl(fd, TIOCGSERIAL, &settings) != 0) return false;
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  return ioctl(fd, TIOCSSERIAL, &settings) == 0;
}

}  // namespace tautline
