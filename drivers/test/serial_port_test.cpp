#include "drivers/serial_port.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/testing/unprivileged.h"
#include "drivers/serial_settings.h"
#include "drivers/test/pty.h"

namespace tautline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Pty;
using testing::TemporaryFolder;
using testing::Unprivileged;
using namespace std::chrono_literals;

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string readAll(SerialPort& port) {
  std::string all;
  std::array<std::uint8_t, 64> buffer{};
  for (;;) {
    const std::size_t count = port.read(buffer).count;
    if (count == 0) return all;
    all.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

SerialConfig configFor(const std::string& path) {
  SerialConfig config;
  config.device = path;
  return config;
}

TEST(SerialPort, SetsRaw8N1At115200) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  const SerialOpenResult result = port.open();
  ASSERT_TRUE(result) << result.reason;
  EXPECT_EQ(result.reason, "");

  // Independent of the driver: the C library's view of the same terminal.
  termios settings{};
  ASSERT_EQ(tcgetattr(pty.master(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN), 0U);
  EXPECT_EQ(settings.c_iflag & static_cast<tcflag_t>(ICRNL | INLCR | IGNCR | IXON | IXOFF | ISTRIP),
            0U);
  EXPECT_EQ(settings.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  EXPECT_EQ(settings.c_cflag & static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB),
            static_cast<tcflag_t>(CS8));
  EXPECT_EQ(settings.c_cc[VMIN], 0);
  EXPECT_EQ(settings.c_cc[VTIME], 0);
  EXPECT_EQ(cfgetospeed(&settings), static_cast<speed_t>(B115200));
}

TEST(SerialPort, TakesAnyBaudRateAndReadsItBack) {
  for (const int baud : {50, 9600, 115200, 123456, 250000, 1000000, 4000000}) {
    Pty pty;
    SerialConfig config = configFor(pty.path());
    config.baud = baud;
    SerialPort port(config);
    const SerialOpenResult result = port.open();
    ASSERT_TRUE(result) << result.reason;
    SerialSettings settings;
    ASSERT_TRUE(getSerialSettings(pty.master(), settings));
    EXPECT_EQ(settings.baud, baud);
  }
}

TEST(SerialPort, PassesEveryByteValueUnchangedBothWays) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  pty.send(all);
  EXPECT_EQ(readAll(port), all);
  EXPECT_TRUE(port.write(bytesOf(all)).accepted);
  EXPECT_EQ(pty.receive(), all);
  EXPECT_EQ(port.counters().bytes_in, 256U);
  EXPECT_EQ(port.counters().bytes_out, 256U);
}

TEST(SerialPort, NothingToReadIsNotALostLink) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(readAll(port), "");
  EXPECT_TRUE(port.connected());
}

TEST(SerialPort, SaysWhatIsWrongAndWhatToDo) {
  TemporaryFolder folder;
  {
    SerialPort port(configFor((folder.path() / "ttyACM0").string()));
    const SerialOpenResult result = port.open();
    EXPECT_EQ(result.status, SerialStatus::kNoSuchDevice);
    EXPECT_THAT(result.reason, AllOf(HasSubstr("ttyACM0"), HasSubstr("plug it in")));
    EXPECT_FALSE(port.connected());
  }
  for (const std::string& path : {std::string("/dev/null"), folder.path().string()}) {
    SerialPort port(configFor(path));
    const SerialOpenResult result = port.open();
    EXPECT_EQ(result.status, SerialStatus::kNotATty) << path;
    EXPECT_THAT(result.reason, AllOf(HasSubstr(path), HasSubstr("not a serial device")));
  }
}

TEST(SerialPort, NamesTheGroupWhenPermissionIsMissing) {
  Pty pty;
  ASSERT_EQ(chmod(pty.path().c_str(), 0), 0);
  const Unprivileged nobody;
  SerialPort port(configFor(pty.path()));
  const SerialOpenResult result = port.open();
  EXPECT_EQ(result.status, SerialStatus::kPermission);
  EXPECT_THAT(result.reason, HasSubstr("dialout"));
}

TEST(SerialPort, IsExclusiveAndNamesTheHolder) {
  Pty pty;
  SerialPort first(configFor(pty.path()));
  ASSERT_TRUE(first.open());
  SerialPort second(configFor(pty.path()));
  const SerialOpenResult result = second.open();
  EXPECT_EQ(result.status, SerialStatus::kBusy);
  EXPECT_THAT(result.reason, HasSubstr("pid " + std::to_string(getpid())));
  EXPECT_TRUE(first.connected());
}

TEST(SerialPort, NoticesUnpluggingAndComesBackUnderTheSamePath) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  Time now{};
  port.poll(now);
  pty.unplug();
  EXPECT_EQ(readAll(port), "");
  EXPECT_FALSE(port.connected());
  EXPECT_EQ(port.status(), SerialStatus::kUnplugged);
  EXPECT_FALSE(port.write(bytesOf("lost\n")).accepted);
  EXPECT_EQ(port.counters().bytes_dropped, 5U);

  port.poll(now);
  pty.plug();
  port.poll(now + 50ms);  // before the first retry is due
  EXPECT_FALSE(port.connected());
  port.poll(now + 100ms);
  EXPECT_TRUE(port.connected());
  EXPECT_EQ(port.counters().reconnects, 1U);
  EXPECT_TRUE(port.write(bytesOf("back\n")).accepted);
  EXPECT_EQ(pty.receive(), "back\n");
  pty.send("hello");
  EXPECT_EQ(readAll(port), "hello");
}

TEST(SerialPort, NoticesUnpluggingWhenItOnlyWrites) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  pty.unplug();
  port.write(bytesOf("anyone?\n"));
  EXPECT_FALSE(port.connected());
  EXPECT_EQ(port.counters().bytes_dropped, 8U);
}

TEST(SerialPort, RetriesSlowlyAfterALongTimeButNeverGivesUp) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  for (int round = 0; round < 3; ++round) {
    pty.unplug();
    EXPECT_EQ(readAll(port), "");
    Time now{};
    for (; now < Time{} + 600s; now += 10ms) port.poll(now);
    EXPECT_EQ(port.status(), SerialStatus::kNoSuchDevice);
    pty.plug();
    const Time plugged = now;
    while (!port.connected() && now < plugged + 10s) port.poll(now += 10ms);
    EXPECT_LE(toSeconds(now - plugged), 2.0);
    port.poll(now);
  }
  EXPECT_EQ(port.counters().reconnects, 3U);
}

/// A port that has lost its device and tries again, and what it says about it.
class SerialPortThatTries : public ::testing::Test {
 protected:
  SerialPortThatTries() : port_(configFor(pty_.path())) {
    EXPECT_TRUE(port_.open());
    EXPECT_EQ(port_.fault(), LinkFault::kNone);
    pty_.unplug();
    EXPECT_EQ(readAll(port_), "");
    EXPECT_EQ(port_.fault(), LinkFault::kPortMissing);
    std::filesystem::permissions(std::filesystem::path(pty_.path()).parent_path(),
                                 std::filesystem::perms::all);  // for Unprivileged
  }
  /// As long as any back-off.
  LinkFault faultAfterTrying() {
    for (const Time end = now_ + 5s; now_ < end; now_ += 10ms) port_.poll(now_);
    return port_.fault();
  }
  /// The device is there again, for everybody.
  void plugIn() {
    pty_.plug();
    ASSERT_EQ(chmod(pty_.path().c_str(), 0666), 0);
  }

  Pty pty_;
  SerialPort port_;
  Time now_{};
};

TEST_F(SerialPortThatTries, NamesADeviceThatAnotherProgramHas) {
  plugIn();
  const int other = ::open(pty_.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(other, 0);
  ASSERT_EQ(ioctl(other, TIOCEXCL), 0);
  const Unprivileged nobody;
  EXPECT_EQ(faultAfterTrying(), LinkFault::kPortBusy);
  ASSERT_EQ(ioctl(other, TIOCNXCL),
            0);  // a real device forgets it when it is closed, a pty does not
  ::close(other);
  EXPECT_EQ(faultAfterTrying(), LinkFault::kNone);
  EXPECT_TRUE(port_.connected());
  EXPECT_EQ(port_.counters().reconnects, 1U);
}

TEST_F(SerialPortThatTries, NamesADeviceThatAnotherStationHas) {
  plugIn();
  {
    SerialPort other(configFor(pty_.path()));
    ASSERT_TRUE(other.open());
    EXPECT_EQ(faultAfterTrying(), LinkFault::kPortBusy);
  }
  EXPECT_EQ(faultAfterTrying(), LinkFault::kNone);
}

TEST_F(SerialPortThatTries, NamesADeviceThatItMayNotUse) {
  pty_.plug();
  ASSERT_EQ(chmod(pty_.path().c_str(), 0), 0);
  {
    const Unprivileged nobody;
    EXPECT_EQ(faultAfterTrying(), LinkFault::kPortPermission);
  }
  ASSERT_EQ(chmod(pty_.path().c_str(), 0666), 0);
  EXPECT_EQ(faultAfterTrying(), LinkFault::kNone);
}

TEST_F(SerialPortThatTries, NamesADeviceThatIsNotThere) {
  EXPECT_EQ(faultAfterTrying(), LinkFault::kPortMissing);
}

TEST_F(SerialPortThatTries, NamesAPathThatIsNoSerialDevice) {
  std::filesystem::remove(pty_.path());
  std::filesystem::create_symlink("/dev/null", pty_.path());
  EXPECT_EQ(faultAfterTrying(), LinkFault::kNotSerial);
}

TEST(SerialPort, NamesARealDeviceThatComesLater) {
  TemporaryFolder folder;
  SerialConfig config = configFor((folder.path() / "ttyACM0").string());
  config.pseudo_terminal_only = true;
  SerialPort port(config);
  ASSERT_FALSE(port.open());
  EXPECT_EQ(port.fault(), LinkFault::kPortMissing);
  std::filesystem::create_symlink("/dev/null", config.device);  // a device, and no pseudo terminal
  for (Time now{}; now < Time{} + 1s; now += 10ms) port.poll(now);
  EXPECT_EQ(port.fault(), LinkFault::kRealDevice);
  EXPECT_FALSE(port.connected());
}

TEST(SerialPort, KeepsTryingWhenTheDeviceWasMissingAtTheStart) {
  Pty pty;
  pty.unplug();
  SerialPort port(configFor(pty.path()));
  ASSERT_FALSE(port.open());
  pty.plug();
  Time now{};
  port.poll(now);
  port.poll(now + 100ms);
  EXPECT_TRUE(port.connected());
  EXPECT_EQ(port.counters().reconnects, 0U);  // it was never there before
}

// Nobody reads the far end: the port neither blocks nor cuts a message, keeps the newest and counts
// what it gave up.
TEST(SerialPort, FullOutputDropsTheOldestWholeMessages) {
  Pty pty;
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.open());
  constexpr int kMessages = 5000;
  std::uint64_t total = 0;
  for (int i = 0; i < kMessages; ++i) {
    const std::string message = "Message " + std::to_string(i) + "\n";
    EXPECT_TRUE(port.write(bytesOf(message)).accepted);
    total += message.size();
  }
  EXPECT_TRUE(port.connected());
  EXPECT_GT(port.counters().bytes_dropped, total / 2);

  std::vector<std::string> lines;
  for (int i = 0; i < 100; ++i) {
    for (std::string& line : pty.receiveLines()) lines.push_back(std::move(line));
    port.poll(Time{} + i * 10ms);
  }
  int last = -1;
  for (const std::string& line : lines) {
    ASSERT_EQ(line.rfind("Message ", 0), 0U) << "cut: " << line;
    int number = -1;
    const auto [end, error] = std::from_chars(line.data() + 8, line.data() + line.size(), number);
    ASSERT_EQ(error, std::errc{}) << line;
    ASSERT_EQ(end, line.data() + line.size()) << "cut: " << line;
    ASSERT_GT(number, last);
    last = number;
  }
  EXPECT_EQ(last, kMessages - 1);
  EXPECT_EQ(port.counters().bytes_out + port.counters().bytes_dropped, total);
}

TEST(SerialPort, TakesOverATerminalOpenedBySomeoneElse) {
  Pty pty;
  const int fd = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(fd, 0);
  SerialPort port(configFor(pty.path()));
  ASSERT_TRUE(port.adopt(fd));
  EXPECT_NE(fcntl(fd, F_GETFL) & O_NONBLOCK, 0);
  pty.send("abc\r\n");
  EXPECT_EQ(readAll(port), "abc\r\n");
}

TEST(SerialPort, TakesOverASocketAndStaysClosedWithoutAPath) {
  std::array<int, 2> ends{};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  SerialPort port(configFor(""));
  ASSERT_TRUE(port.adopt(ends[0]));
  EXPECT_EQ(readAll(port), "");
  EXPECT_TRUE(port.connected());
  ASSERT_EQ(::write(ends[1], "abc", 3), 3);
  EXPECT_EQ(readAll(port), "abc");
  ::close(ends[1]);
  EXPECT_EQ(readAll(port), "");
  EXPECT_FALSE(port.connected());
  for (int i = 0; i < 100; ++i) port.poll(Time{} + i * 1s);
  EXPECT_FALSE(port.connected());
}

}  // namespace
}  // namespace tautline
