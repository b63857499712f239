#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "common/error.h"
#include "sim_hil/pty_link.h"
#include "sim_hil/simulator.h"
#include "sim_hil/test/flight_rig.h"
#include "sim_hil/test/wire_client.h"

extern char** environ;

namespace tautline::sim {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "tautline_sim_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// The client's end of the line.
class Port {
 public:
  explicit Port(const fs::path& path) : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    termios settings{};
    ::tcgetattr(fd_, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(fd_, TCSANOW, &settings);
  }
  ~Port() { ::close(fd_); }
  [[nodiscard]] bool good() const { return fd_ >= 0; }
  void send(const std::string& text) const {
    EXPECT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::string receive() const {
    std::string all;
    std::array<char, 4096> buffer;
    for (ssize_t n = ::read(fd_, buffer.data(), buffer.size()); n > 0;
         n = ::read(fd_, buffer.data(), buffer.size())) {
      all.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return all;
  }

 private:
  int fd_;
};

/// Opens the terminal, claims it for itself and dies without giving it back.
bool claimAndDie(const fs::path& link) {
  const int fd = ::open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  const bool claimed = fd >= 0 && ::ioctl(fd, TIOCEXCL) == 0;
  ::close(fd);
  return claimed;
}

// Root may open a claimed terminal, so a child without root's rights tries it, and one with them.
TEST(PtyLink, AClientThatWasKilledLeavesNoClaimBehind) {
  constexpr unsigned kNobody = 65534;
  for (const bool as_nobody : {false, true}) {
    Folder folder;
    const fs::path path = folder / "device";
    const auto reopen = [&] {
      if (as_nobody && ::geteuid() == 0) {
        if (::chown(path.parent_path().c_str(), kNobody, kNobody) != 0 || ::setuid(kNobody) != 0)
          ::_exit(10);
      }
      PtyLink link(path);
      std::array<std::uint8_t, 16> bytes{};
      for (int client = 0; client < 3; ++client) {
        const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
        if (fd < 0) ::_exit(20 + client);
        if (link.read(bytes) != 0 || !link.hasClient()) ::_exit(30 + client);
        ::close(fd);
        if (!claimAndDie(path)) ::_exit(40 + client);
        if (link.read(bytes) != 0 || link.hasClient()) ::_exit(50 + client);
      }
      ::_exit(0);
    };
    EXPECT_EXIT(reopen(), ::testing::ExitedWithCode(0), "") << "as nobody: " << as_nobody;
  }
}

TEST(PtyLink, MakesAndRemovesItsLink) {
  const Folder folder;
  const fs::path link = folder / "device";
  {
    const PtyLink pty(link);
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(fs::read_symlink(link), pty.slave());
  }
  EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
}

TEST(PtyLink, ReplacesAnOldLinkButNoFile) {
  const Folder folder;
  fs::create_symlink("/nowhere", folder / "old");
  { const PtyLink pty(folder / "old"); }
  std::ofstream(folder / "file") << "precious";
  EXPECT_THROW(PtyLink(folder / "file"), InputError);
  EXPECT_TRUE(fs::is_regular_file(folder / "file"));
  EXPECT_THROW(PtyLink(folder / "no/such/folder"), InputError);
}

TEST(PtyLink, ClientsComeAndGo) {
  const Folder folder;
  PtyLink pty(folder / "device");
  std::array<std::uint8_t, 64> buffer;
  const std::array<std::uint8_t, 3> hello{'h', 'i', '\n'};
  EXPECT_EQ(pty.read(buffer), 0U);
  EXPECT_FALSE(pty.hasClient());
  EXPECT_EQ(pty.write(hello), 3U);  // into nowhere
  for (int i = 0; i < 3; ++i) {
    {
      const Port port(folder / "device");
      ASSERT_TRUE(port.good());
      EXPECT_EQ(pty.read(buffer), 0U);
      EXPECT_TRUE(pty.hasClient());
      EXPECT_EQ(port.receive(), "") << "nothing from before";
      EXPECT_EQ(pty.write(hello), 3U);
      EXPECT_EQ(port.receive(), "hi\n");
      port.send("ok\n");
      EXPECT_EQ(pty.read(buffer), 3U);
    }
    EXPECT_EQ(pty.read(buffer), 0U);
    EXPECT_FALSE(pty.hasClient());
  }
}

TEST(PtyLink, UnpluggedItIsGoneForItsClientUntilPluggedInAgain) {
  const Folder folder;
  PtyLink pty(folder / "device");
  std::array<std::uint8_t, 16> buffer;
  const std::array<std::uint8_t, 3> hello{'h', 'i', '\n'};
  const Port before(folder / "device");
  ASSERT_EQ(pty.read(buffer), 0U);
  ASSERT_TRUE(pty.hasClient());
  for (int twice = 0; twice < 2; ++twice) pty.plug(false);
  EXPECT_FALSE(fs::exists(fs::symlink_status(folder / "device")));
  EXPECT_EQ(pty.read(buffer), 0U);
  EXPECT_FALSE(pty.hasClient());
  EXPECT_EQ(pty.write(hello), 3U);  // into nowhere
  EXPECT_EQ(before.receive(), "");
  for (int twice = 0; twice < 2; ++twice) pty.plug(true);
  const Port after(folder / "device");
  ASSERT_TRUE(after.good());
  EXPECT_EQ(pty.read(buffer), 0U);
  EXPECT_TRUE(pty.hasClient());
  EXPECT_EQ(pty.write(hello), 3U);
  EXPECT_EQ(after.receive(), "hi\n");
}

TEST(PtyLink, AClientThatDoesNotReadDoesNotBlock) {
  const Folder folder;
  PtyLink pty(folder / "device");
  const Port port(folder / "device");
  std::array<std::uint8_t, 4096> block{};
  static_cast<void>(pty.read(block));
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += pty.write(block);
  EXPECT_LT(taken, 1000 * block.size());
}

/// A client written by someone else: only the start sequence, StartTakeoff, Pos and MotorStop, and
/// what it reads. Real terminal, virtual time.
class ForeignFlight {
 public:
  ForeignFlight() : pty_(folder_ / "device"), port_(folder_ / "device") {}

  void wait(double duration) {
    const Time end = sim_.now() + fromSeconds(duration);
    while (sim_.now() < end) {
      const std::size_t n = pty_.read(buffer_);
      sim_.receive(std::span(buffer_).first(n));
      sim_.advanceTo(sim_.now() + milliseconds(20));
      const std::size_t m = sim_.transmit(buffer_);
      ASSERT_EQ(pty_.write(std::span(buffer_).first(m)), m);
      client.take(port_.receive());
    }
  }
  void send(const std::string& text) { port_.send(text); }
  /// Sends `command` ten times a second until `done`, at most `limit` seconds.
  bool keep(const std::string& command, double limit, const std::function<bool()>& done) {
    for (double t = 0.0; t < limit; t += 0.1) {
      if (done()) return true;
      send(command + "\n");
      wait(0.1);
    }
    return done();
  }
  const Truth& truth() { return sim_.truth(); }

  WireClient client;

 private:
  Folder folder_;
  Simulator sim_{SimConfig{}, emptyRoom(), 3};
  PtyLink pty_;
  Port port_;
  std::array<std::uint8_t, 4096> buffer_{};
};

TEST(ForeignClient, FliesUpOutRoundAndLands) {
  ForeignFlight f;
  const auto never = [] { return false; };
  for (char c : WireClient::startSequence()) f.send(std::string(1, c));
  f.wait(2.0);
  ASSERT_EQ(f.client.number("!GSStatus", 0), 10);
  ASSERT_EQ(f.client.number("!FlightStatus", 0), 1);
  const double start_counts = f.client.number("!GSStatus", 3);
  const double start_elevation = f.client.number("!Pos", 0);
  const double start_azimuth = f.client.number("!Pos", 1);

  f.send("StartTakeoff\n");
  ASSERT_TRUE(f.keep("Pos 0,0,0", 15.0, [&] {
    return f.client.number("!FlightStatus", 0) == 2 && f.client.number("!Pos", 0) < 0.75;
  })) << "up";
  EXPECT_FALSE(f.truth().on_ground);
  ASSERT_TRUE(f.keep("Pos 0,0,8", 20.0, [&] {
    return f.client.number("!GSStatus", 3) > start_counts + 300;
  })) << "out";
  EXPECT_NEAR(f.truth().length, (start_counts + 300) * 0.00285, 0.05);
  ASSERT_TRUE(f.keep("Pos 0,0.1,0", 15.0, [&] {
    return f.client.number("!Pos", 1) > start_azimuth + 0.5;
  })) << "round";
  f.keep("Pos 0,0,0", 3.0, never);
  EXPECT_GT(f.truth().p_WD.x(), 0.4);
  EXPECT_GT(f.truth().p_WD.y(), 0.5);
  ASSERT_TRUE(f.keep("Pos 0,0,-8", 20.0, [&] {
    return f.client.number("!GSStatus", 3) < start_counts + 5;
  })) << "in";
  ASSERT_TRUE(f.keep("Pos -0.1,0,0", 30.0, [&] {
    return f.client.number("!Pos", 0) > start_elevation - 0.02;
  })) << "down";
  f.keep("Pos -0.05,0,0", 3.0, never);
  f.send("MotorStop\n");
  f.wait(3.0);
  EXPECT_EQ(f.client.number("!FlightStatus", 0), 1);
  EXPECT_TRUE(f.truth().on_ground);
  EXPECT_FALSE(f.truth().motors_on);
  EXPECT_FALSE(f.truth().crashed);
  EXPECT_EQ(f.client.badLines(), 0);
}

// --- the program
// ----------------------------------------------------------------------------------

/// A child process of ours.
class Program {
 public:
  Program(const fs::path& output, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), TAUTLINE_SIM_PROGRAM);
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    EXPECT_EQ(posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
  }
  ~Program() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      static_cast<void>(wait());
    }
  }
  void signal(int number) const { ::kill(pid_, number); }
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_{-1};
};

std::string contentOf(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Condition>
bool eventually(Condition&& condition) {
  for (int i = 0; i < 500; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

TEST(TautlineSim, ServesAClientAgainAndAgainAndStopsOnASignal) {
  const Folder folder;
  const fs::path link = folder / "device";
  for (const int number : {SIGTERM, SIGINT}) {
    Program program(folder / "out.txt", {"--pty", link.string(), "--no-lcm", "--rate-hz", "50"});
    ASSERT_TRUE(eventually([&] { return fs::exists(link); }));
    for (int i = 0; i < 2; ++i) {
      std::this_thread::sleep_for(milliseconds(50));  // it has seen that the last client left
      const Port port(link);
      WireClient client;
      port.send(WireClient::startSequence());
      EXPECT_TRUE(eventually([&] {
        client.take(port.receive());
        return client.count("!Pos") > 5;
      })) << contentOf(folder / "out.txt");
      EXPECT_EQ(client.badLines(), 0);
    }
    program.signal(number);
    EXPECT_EQ(program.wait(), 0);
    EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
    const std::string out = contentOf(folder / "out.txt");
    EXPECT_NE(out.find("serving Fotokite protocol on " + link.string()), std::string::npos) << out;
    EXPECT_NE(out.find("2 client(s)"), std::string::npos) << out;
  }
}

TEST(TautlineSim, BadInputIsOneLineAndTheRightExitCode) {
  const Folder folder;
  const fs::path out = folder / "out.txt";
  const auto run = [&](std::vector<std::string> arguments) {
    return Program(out, std::move(arguments)).wait();
  };
  std::ofstream(folder / "typo.toml") << "[vehicle]\nmas_kg = 0.6\n";
  std::ofstream(folder / "range.toml") << "step_s = 1.0\n";
  EXPECT_EQ(run({"--config", (folder / "typo.toml").string(), "--check-config"}), 5);
  EXPECT_NE(contentOf(out).find("typo.toml:2"), std::string::npos) << contentOf(out);
  EXPECT_EQ(run({"--config", (folder / "range.toml").string(), "--check-config"}), 5);
  EXPECT_EQ(run({"--scene", (folder / "none.toml").string(), "--check-config"}), 5);
  EXPECT_EQ(run({"--seed", "abc"}), 2);
  EXPECT_EQ(run({}), 2);
  std::ofstream(folder / "file") << "x";
  EXPECT_EQ(run({"--pty", (folder / "file").string(), "--no-lcm"}), 1);
  const std::string text = contentOf(out);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_EQ(run({"--config", TAUTLINE_SOURCE_DIR "/config/sim.toml", "--check-config"}), 0);
  EXPECT_EQ(run({"--print-config"}), 0);
  fs::copy_file(out, folder / "printed.toml");
  EXPECT_EQ(run({"--config", (folder / "printed.toml").string(), "--check-config"}), 0);
}

TEST(TautlineSim, StopsByItselfAfterItsDuration) {
  const Folder folder;
  Program program(folder / "out.txt",
                  {"--pty", (folder / "device").string(), "--no-lcm", "--duration", "0.3"});
  EXPECT_EQ(program.wait(), 0);
}

}  // namespace
}  // namespace tautline::sim
