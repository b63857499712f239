#include "app/station/service_notifier.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/station/test/notify_socket.h"
#include "common/testing/malloc_guard.h"

namespace tautline {
namespace {

using std::chrono::milliseconds;
using tautline::testing::NotifySocket;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string socketPath() {
  return ::testing::TempDir() + "tautline_notify_" + std::to_string(getpid());
}
Time at(int ms) { return Time(milliseconds(ms)); }

TEST(ServiceNotifier, IsReadyAfterTheFirstCycleInTimeAndThenGivesSignsOfLife) {
  for (const std::string& name : {socketPath(), "@tautline-notify-" + std::to_string(getpid())}) {
    NotifySocket manager(name);
    ServiceNotifier notifier({.socket = name, .watchdog = milliseconds(400)});
    EXPECT_EQ(notifier.error(), "");
    EXPECT_THAT(manager.take(), IsEmpty()) << "nothing before the first cycle";
    notifier.cycleDone(at(1000), false);
    EXPECT_THAT(manager.take(), IsEmpty()) << "a late cycle is none";
    notifier.cycleDone(at(1010), true);
    EXPECT_THAT(manager.take(), ElementsAre(StartsWith("READY=1\n")));
    for (int ms = 1020; ms < 1110; ms += 10) notifier.cycleDone(at(ms), true);
    EXPECT_THAT(manager.take(), IsEmpty()) << "not more often than four times an interval";
    for (int ms = 1110; ms < 1510; ms += 10) notifier.cycleDone(at(ms), true);
    EXPECT_THAT(manager.take(),
                ElementsAre("WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1"));
    notifier.stopping();
    EXPECT_THAT(manager.take(), ElementsAre(StartsWith("STOPPING=1\n")));
  }
}

TEST(ServiceNotifier, LateCyclesStarveTheWatchdog) {
  NotifySocket manager(socketPath());
  ServiceNotifier notifier({.socket = manager.name(), .watchdog = milliseconds(400)});
  notifier.cycleDone(at(0), true);
  manager.take();
  for (int ms = 0; ms < 10'000; ms += 20) notifier.cycleDone(at(ms), false);
  EXPECT_THAT(manager.take(), IsEmpty());
  notifier.cycleDone(at(10'000), true);
  EXPECT_THAT(manager.take(), ElementsAre("WATCHDOG=1"));
}

TEST(ServiceNotifier, WithoutAWatchdogItSaysReadyAndNoMore) {
  NotifySocket manager(socketPath());
  ServiceNotifier notifier({.socket = manager.name()});
  for (int ms = 0; ms < 5000; ms += 10) notifier.cycleDone(at(ms), true);
  EXPECT_THAT(manager.take(), ElementsAre(StartsWith("READY=1\n")));
}

// A manager that does not read fills its queue: nothing waits, and the sign comes when there is
// room again.
TEST(ServiceNotifier, NeverWaitsForAManagerThatDoesNotRead) {
  NotifySocket manager(socketPath());
  ServiceNotifier notifier({.socket = manager.name(), .watchdog = milliseconds(4)});
  const tautline::testing::MallocGuard guard;
  for (int ms = 0; ms < 10'000; ++ms) notifier.cycleDone(at(ms), true);
  if (tautline::testing::MallocGuard::available()) {
    EXPECT_EQ(guard.allocations(), 0);
  }
  const std::size_t queued = manager.take().size();
  EXPECT_GT(queued, 0U);
  EXPECT_LT(queued, 10'000U);
  notifier.cycleDone(at(10'000), true);
  EXPECT_THAT(manager.take(), ElementsAre("WATCHDOG=1"));
}

TEST(ServiceNotifier, AnUnreachableManagerIsAnErrorAndNoMore) {
  ServiceNotifier nowhere({.socket = socketPath() + "_nobody"});
  EXPECT_THAT(nowhere.error(), ::testing::HasSubstr("NOTIFY_SOCKET"));
  nowhere.cycleDone(at(0), true);
  nowhere.stopping();
  ServiceNotifier too_long({.socket = std::string(200, 'x')});
  EXPECT_THAT(too_long.error(), ::testing::HasSubstr("longer"));
  ServiceNotifier by_hand(ServiceManager{});
  EXPECT_EQ(by_hand.error(), "");
}

TEST(ServiceManager, TakesTheWatchdogOnlyIfItIsMeantForThisProcess) {
  setenv("NOTIFY_SOCKET", "/run/somewhere", 1);
  setenv("WATCHDOG_USEC", "2000000", 1);
  unsetenv("WATCHDOG_PID");
  EXPECT_EQ(serviceManagerFromEnvironment().socket, "/run/somewhere");
  EXPECT_EQ(serviceManagerFromEnvironment().watchdog, std::chrono::seconds(2));
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_EQ(serviceManagerFromEnvironment().watchdog, std::chrono::seconds(2));
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(serviceManagerFromEnvironment().watchdog, Duration::zero());
  unsetenv("WATCHDOG_PID");
  for (const char* bad : {"", "-5", "soon", "12x", "99999999999999999999"}) {
    setenv("WATCHDOG_USEC", bad, 1);
    EXPECT_EQ(serviceManagerFromEnvironment().watchdog, Duration::zero()) << bad;
  }
  unsetenv("WATCHDOG_USEC");
  unsetenv("NOTIFY_SOCKET");
  EXPECT_EQ(serviceManagerFromEnvironment().socket, "");
}

}  // namespace
}  // namespace tautline
