// Programs as processes: how they end, what they said, and that none is left behind.

#include "app/bench/child_program.h"

#include <signal.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "app/bench/hil_rig.h"
#include "common/clock.h"
#include "common/error.h"
#include "common/loop_timer.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> shell(const std::string& script) { return {"-c", script}; }

std::string waitForEnd(ChildProgram& program) {
  std::string how;
  for (int i = 0; i < 1000 && how.empty(); ++i) {
    sleepUntil(monotonicNow() + std::chrono::milliseconds(10));
    how = program.ended();
  }
  return how;
}

/// What the program writes into `file` of its folder, once it is there.
std::string fileOf(const fs::path& file) {
  std::string word;
  for (int i = 0; i < 1000 && word.empty(); ++i) {
    sleepUntil(monotonicNow() + std::chrono::milliseconds(10));
    std::ifstream(file) >> word;
  }
  return word;
}

TEST(ChildProgram, ItsEndIsToldWithItsLastLine) {
  const TemporaryFolder folder;
  ChildProgram failing("/bin/sh", shell("echo one; echo two >&2; exit 5"), folder.path());
  EXPECT_EQ(waitForEnd(failing), "sh ended with code 5: two");
  EXPECT_EQ(failing.end(), "sh ended with code 5: two") << "as before";
  ChildProgram killed("/bin/sh", shell("kill -KILL $$"), folder.path());
  EXPECT_EQ(waitForEnd(killed), "sh was ended by signal 9: ");
}

TEST(ChildProgram, EndsWhenItIsAskedTo) {
  const TemporaryFolder folder;
  ChildProgram program("/bin/sh", shell("trap 'exit 0' TERM; while :; do sleep 0.01; done"),
                       folder.path());
  EXPECT_EQ(program.ended(), "");
  EXPECT_EQ(program.lastLine(), "");
  program.standStill(std::chrono::milliseconds(50));
  EXPECT_EQ(program.ended(), "");
  sleepUntil(monotonicNow() + std::chrono::milliseconds(300));
  EXPECT_EQ(program.end(), "");
}

TEST(ChildProgram, OneThatDoesNotListenIsKilledAndNothingIsLeft) {
  const TemporaryFolder folder;
  pid_t process = 0;
  {
    ChildProgram deaf(
        "/bin/sh", shell("trap '' TERM; echo $$ >$XDG_RUNTIME_DIR/id; while :; do sleep 1; done"),
        folder.path());
    process = static_cast<pid_t>(std::stoi(fileOf(folder.path() / "id")));
    ASSERT_EQ(::kill(process, 0), 0);
  }
  EXPECT_NE(::kill(process, 0), 0);
}

TEST(ChildProgram, OneThatCannotBeStartedSaysSo) {
  const TemporaryFolder folder;
  ChildProgram nothing("/no/such/program", {}, folder.path());
  EXPECT_EQ(waitForEnd(nothing), "program ended with code 127: ");
  EXPECT_THROW(static_cast<void>(programBeside("no-such-program")), InputError);
}

TEST(ChildProgram, TheServiceManagersSocketIsNotItsOwn) {
  const TemporaryFolder folder;
  ::setenv("NOTIFY_SOCKET", "/nowhere", 1);
  ChildProgram program("/bin/sh",
                       shell("echo \"${NOTIFY_SOCKET:-none}\" >$XDG_RUNTIME_DIR/socket; exit 0"),
                       folder.path());
  EXPECT_EQ(fileOf(folder.path() / "socket"), "none");
  ::unsetenv("NOTIFY_SOCKET");
}

TEST(TemporaryFolder, IsGoneWithItsObject) {
  fs::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    std::ofstream(path / "file") << "text";
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace tautline::bench
