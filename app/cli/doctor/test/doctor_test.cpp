// Every finding about real time, on a machine made of files. The others are provoked on the real
// one: app/cli/test/doctor_test.py.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/cli/doctor/check.h"
#include "app/cli/doctor/latency.h"
#include "app/cli/doctor/real_time_checks.h"
#include "app/cli/doctor/station_checks.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A machine on which every check is content, to be spoilt one file at a time.
class DoctorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) /
            ("tautline_doctor_" +
             std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(root_);
    machine_.root = root_;
    machine_.clock_synchronized = [] { return true; };
    machine_.lateness = [](Duration, Duration) {
      return std::vector<Duration>(1000, microseconds(20));
    };
    limits("98", "unlimited");
    capabilities("0000000000000000");
    write("proc/sys/kernel/sched_rt_runtime_us", "950000");
    write("proc/sys/kernel/osrelease", "6.1.0-rt");
    write("proc/sys/kernel/arch", "aarch64");
    write("sys/kernel/realtime", "1");
    for (const char* cpu : {"cpu0", "cpu1", "cpu2", "cpu3"})
      write("sys/devices/system/cpu/" + std::string(cpu) + "/cpufreq/scaling_governor",
            "performance");
    fs::create_directories(root_ / "sys/devices/system/cpu/cpufreq");
    fs::create_directories(root_ / "sys/devices/system/cpu/cpuidle");
    write("sys/devices/system/cpu/isolated", "3");
    clockSource("arch_sys_counter", "arch_sys_counter");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text << '\n';
  }
  /// In the kernel's own form.
  void limits(const std::string& rtprio, const std::string& memlock) const {
    write("proc/self/limits",
          "Limit                     Soft Limit           Hard Limit           Units     \n"
          "Max locked memory         " +
              memlock +
              "              8388608              bytes\n"
              "Max realtime priority     " +
              rtprio +
              "                    0\n"
              "Max realtime timeout      unlimited            unlimited            us");
  }
  void capabilities(const std::string& hex) const {
    write("proc/self/status", "Name:\ttautline\nCapPrm:\tffffffffffffffff\nCapEff:\t" + hex);
  }
  void clockSource(const std::string& current, const std::string& available) const {
    write("sys/devices/system/clocksource/clocksource0/current_clocksource", current);
    write("sys/devices/system/clocksource/clocksource0/available_clocksource", available);
  }

  fs::path root_;
  Machine machine_;
};

std::vector<Check> realTimeChecks() {
  std::vector<Check> checks = allChecks();
  std::erase_if(checks, [](const Check& c) { return c.group != CheckGroup::kRealTime; });
  return checks;
}

void expectBad(const Finding& f, FindingStatus status, const std::string& measured,
               const std::string& remedy) {
  EXPECT_EQ(f.status, status) << f.measured;
  EXPECT_THAT(f.measured, HasSubstr(measured));
  EXPECT_THAT(f.remedy, HasSubstr(remedy));
  EXPECT_THAT(f.wanted, Not(IsEmpty()));
}

TEST_F(DoctorTest, AGoodMachineHasNoFinding) {
  std::set<std::string> names;
  for (const Check& check : realTimeChecks()) {
    const Finding f = check.run(machine_);
    EXPECT_EQ(f.status, FindingStatus::kOk) << check.name << ": " << f.measured;
    EXPECT_THAT(f.measured, Not(IsEmpty())) << check.name;
    EXPECT_EQ(f.wanted + f.remedy, "") << check.name;
    EXPECT_TRUE(names.insert(check.name).second) << "twice: " << check.name;
  }
}

// A folder without anything is the worst machine: no check may fail to answer.
TEST_F(DoctorTest, AnEmptyMachineIsAnsweredByEveryCheck) {
  fs::remove_all(root_);
  machine_.clock_synchronized = nullptr;
  machine_.lateness = nullptr;
  for (const Check& check : realTimeChecks()) {
    const Finding f = check.run(machine_);
    EXPECT_EQ(f.status == FindingStatus::kOk, f.remedy.empty()) << check.name;
  }
  EXPECT_EQ(checkPriority(machine_).status, FindingStatus::kProblem);
  EXPECT_EQ(checkMemlock(machine_).status, FindingStatus::kProblem);
  EXPECT_EQ(checkClockSource(machine_).status, FindingStatus::kProblem);
}

TEST_F(DoctorTest, PriorityNeedsALimitOrACapability) {
  limits("0", "unlimited");
  expectBad(checkPriority(machine_), FindingStatus::kProblem, "up to 0", "usermod");
  limits("49", "unlimited");
  expectBad(checkPriority(machine_), FindingStatus::kProblem, "up to 49", "usermod");
  limits("50", "unlimited");
  EXPECT_EQ(checkPriority(machine_).status, FindingStatus::kOk);
  limits("0", "unlimited");
  capabilities("0000000000800000");  // CAP_SYS_NICE alone
  EXPECT_EQ(checkPriority(machine_).status, FindingStatus::kOk);
  capabilities("ffffffffff7fffff");  // all but it
  EXPECT_EQ(checkPriority(machine_).status, FindingStatus::kProblem);
}

TEST_F(DoctorTest, PriorityIsWorthNothingWithoutRealTimeTime) {
  write("proc/sys/kernel/sched_rt_runtime_us", "0");
  expectBad(checkPriority(machine_), FindingStatus::kProblem, "no time", "sysctl");
  write("proc/sys/kernel/sched_rt_runtime_us", "-1");
  EXPECT_EQ(checkPriority(machine_).status, FindingStatus::kOk);
}

TEST_F(DoctorTest, MemlockNeedsALimitOrACapability) {
  limits("98", "8388608");
  expectBad(checkMemlock(machine_), FindingStatus::kProblem, "8192 KiB", "usermod");
  limits("98", "1073741824");
  EXPECT_EQ(checkMemlock(machine_).status, FindingStatus::kOk);
  limits("98", "0");
  capabilities("0000000000004000");  // CAP_IPC_LOCK alone
  EXPECT_EQ(checkMemlock(machine_).status, FindingStatus::kOk);
}

TEST_F(DoctorTest, KernelShouldBeRealTime) {
  write("sys/kernel/realtime", "0");
  expectBad(checkKernel(machine_), FindingStatus::kAdvice, "not PREEMPT_RT",
            "linux-image-rt-arm64");
  write("proc/sys/kernel/arch", "x86_64");
  fs::remove(root_ / "sys/kernel/realtime");
  expectBad(checkKernel(machine_), FindingStatus::kAdvice, "not PREEMPT_RT",
            "linux-image-rt-amd64");
}

TEST_F(DoctorTest, GovernorIsNamedForEachProcessor) {
  write("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "ondemand");
  const Finding f = checkGovernor(machine_);
  expectBad(f, FindingStatus::kProblem, "cpu2 (ondemand)", "scaling_governor");
  EXPECT_THAT(f.measured, Not(HasSubstr("cpu0")));
  fs::remove_all(root_ / "sys/devices/system/cpu");
  EXPECT_EQ(checkGovernor(machine_).status, FindingStatus::kOk) << "no scaling, nothing to set";
}

TEST_F(DoctorTest, SlowClockSourceNamesTheFastOneThatIsThere) {
  clockSource("hpet", "hpet tsc acpi_pm");
  expectBad(checkClockSource(machine_), FindingStatus::kProblem, "hpet",
            "echo tsc | sudo tee /sys/");
  clockSource("hpet", "hpet acpi_pm tsc-early");
  expectBad(checkClockSource(machine_), FindingStatus::kProblem, "hpet", "journalctl -k");
}

TEST_F(DoctorTest, ClockShouldBeSynchronized) {
  machine_.clock_synchronized = [] { return false; };
  expectBad(checkClockSynchronized(machine_), FindingStatus::kAdvice, "not synchronized",
            "timedatectl set-ntp true");
}

TEST_F(DoctorTest, IsolatedProcessorIsAdviceWithTheBootLoadersCommand) {
  write("sys/devices/system/cpu/isolated", "");
  expectBad(checkIsolatedCpus(machine_), FindingStatus::kAdvice, "none", "update-grub");
  EXPECT_THAT(checkIsolatedCpus(machine_).wanted, HasSubstr("realtime_cpu = 3"));
  write("boot/firmware/cmdline.txt", "console=serial0");
  expectBad(checkIsolatedCpus(machine_), FindingStatus::kAdvice, "none",
            "isolcpus=3 nohz_full=3 rcu_nocbs=3/' /boot/firmware/cmdline.txt");
  for (const char* cpu : {"cpu2", "cpu3"}) fs::remove_all(root_ / "sys/devices/system/cpu" / cpu);
  EXPECT_EQ(checkIsolatedCpus(machine_).status, FindingStatus::kOk)
      << "with two processors none can be spared";
}

TEST_F(DoctorTest, LatencyIsJudgedAtTheRateAndLengthThatWereAskedFor) {
  Duration asked_period{};
  Duration asked_length{};
  std::vector<Duration> lateness(1000, microseconds(90));
  machine_.lateness = [&](Duration period, Duration length) {
    asked_period = period;
    asked_length = length;
    return lateness;
  };
  machine_.loop_rate_hz = 1000.0;
  machine_.latency_s = 2.0;
  EXPECT_EQ(checkLatency(machine_).status, FindingStatus::kOk);
  EXPECT_EQ(asked_period, milliseconds(1));
  EXPECT_EQ(asked_length, std::chrono::seconds(2));
  for (std::size_t i = 0; i < 10; ++i) lateness[i] = microseconds(900);
  EXPECT_EQ(checkLatency(machine_).status, FindingStatus::kOk) << "one in a hundred may be later";
  lateness[10] = microseconds(900);
  expectBad(checkLatency(machine_), FindingStatus::kProblem, "p99 900", "top -H");
  machine_.loop_rate_hz = 100.0;
  EXPECT_EQ(checkLatency(machine_).status, FindingStatus::kOk) << "900 us are little of 10 ms";
  lateness[0] = lateness[1] = milliseconds(11);
  expectBad(checkLatency(machine_), FindingStatus::kProblem, "2 missed", "top -H");
}

TEST(Latency, QuantileIsANearestRank) {
  std::vector<Duration> sorted;
  for (int i = 1; i <= 200; ++i) sorted.emplace_back(i);
  EXPECT_EQ(quantile(sorted, 0.5), Duration(100));
  EXPECT_EQ(quantile(sorted, 0.99), Duration(198));
  EXPECT_EQ(quantile(sorted, 0.991), Duration(199));
  EXPECT_EQ(quantile(sorted, 1.0), Duration(200));
  EXPECT_EQ(quantile({Duration(7)}, 0.01), Duration(7));
}

TEST(Latency, HistogramCountsEveryCycleOnce) {
  const std::string text = latencyHistogram({microseconds(1), microseconds(2), microseconds(3),
                                             microseconds(5), std::chrono::seconds(1)});
  EXPECT_THAT(text, HasSubstr("<=      1 us       1 "));
  EXPECT_THAT(text, HasSubstr("<=      2 us       1 "));
  EXPECT_THAT(text, HasSubstr("<=      5 us       2 "));
  EXPECT_THAT(text, HasSubstr("beyond         1 "));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 17);
}

TEST(Latency, MeasuresEachCycleAndNeverWakesEarly) {
  const auto lateness = measureLateness(milliseconds(1), milliseconds(50));
  EXPECT_EQ(lateness.size(), 50U);
  for (const Duration late : lateness) EXPECT_GE(late, Duration::zero());
}

/// As ip prints a controller: iproute2's own keys, those that matter.
std::string linkJson(const std::string& state, int bitrate) {
  return R"([{"ifindex":3,"ifname":"can0","flags":["NOARP","UP","LOWER_UP","ECHO"],"mtu":16,)"
         R"("operstate":"UP","link_type":"can","linkinfo":{"info_kind":"can","info_data":{"state":")" +
         state + R"(","berr_counter":{"tx":0,"rx":0},"restart_ms":100,"bittiming":{"bitrate":)" +
         std::to_string(bitrate) + R"(,"sample_point":"0.875"},"clock":8000000}}}])";
}

TEST(DoctorCan, ControllersAreJudgedByStateAndBitRate) {
  const auto judge = [](const std::string& json) { return judgeCanLink(json, "can0", 500'000); };
  EXPECT_EQ(judge(linkJson("ERROR-ACTIVE", 500'000)).status, FindingStatus::kOk);
  expectBad(judge(linkJson("BUS-OFF", 500'000)), FindingStatus::kProblem, "BUS-OFF",
            "sudo ip link set can0 down && sudo ip link set can0 up type can bitrate 500000");
  expectBad(judge(linkJson("ERROR-ACTIVE", 250'000)), FindingStatus::kProblem, "250000 bit/s",
            "bitrate 500000");
  expectBad(judge(linkJson("ERROR-PASSIVE", 500'000)), FindingStatus::kAdvice, "ERROR-PASSIVE",
            "ip -details -statistics link show can0");
  expectBad(judge(linkJson("ERROR-ACTIVE", 0)), FindingStatus::kAdvice, "bit rate unknown",
            "bitrate 500000");
  expectBad(judge(""), FindingStatus::kAdvice, "bit rate unknown", "bitrate 500000");
}

}  // namespace
}  // namespace tautline::cli
