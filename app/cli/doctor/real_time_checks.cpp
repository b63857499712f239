#include "app/cli/doctor/real_time_checks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "app/cli/doctor/latency.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;
using enum FindingStatus;

constexpr const char* kJoinGroup =
    "sudo usermod --append --groups tautline \"$USER\", then log in again (the group's limits: "
    "/etc/security/limits.d/tautline.conf)";
constexpr int kWantedPriority = 50;                   // RealTimeConfig's own
constexpr std::int64_t kWantedMemlock = 256LL << 20;  // station with libraries and heap [bytes]
constexpr int kCapIpcLock = 14;                       // capabilities(7)
constexpr int kCapSysNice = 23;
constexpr double kLatencyShare = 0.1;   // of the period
constexpr double kMissedShare = 0.001;  // of the cycles

/// Value of "NAME   soft   hard" in /proc/self/limits; -1 for "unlimited".
std::optional<std::int64_t> softLimit(const Machine& machine, std::string_view name) {
  std::ifstream in(machine.root / "proc/self/limits");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name)) continue;
    const std::size_t begin = line.find_first_not_of(' ', name.size());
    if (begin == std::string::npos) return std::nullopt;
    const std::string_view value = std::string_view(line).substr(begin);
    if (value.starts_with("unlimited")) return -1;
    std::int64_t number = 0;
    if (std::from_chars(value.data(), value.data() + value.size(), number).ec != std::errc())
      return std::nullopt;
    return number;
  }
  return std::nullopt;
}

bool hasCapability(const Machine& machine, int bit) {
  std::ifstream in(machine.root / "proc/self/status");
  for (std::string line; std::getline(in, line);) {
    constexpr std::string_view kKey = "CapEff:\t";
    if (!line.starts_with(kKey)) continue;
    std::uint64_t set = 0;
    std::from_chars(line.data() + kKey.size(), line.data() + line.size(), set, 16);
    return ((set >> bit) & 1U) != 0;
  }
  return false;
}

/// Every cpuN of the machine whose governor is not the wanted one, as "cpu0 (ondemand)".
std::vector<std::string> otherGovernors(const Machine& machine, int& found) {
  std::vector<std::string> others;
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(machine.root / "sys/devices/system/cpu", ignored)) {
    const std::string name = entry.path().filename();
    const std::string governor =
        firstLine(machine, "sys/devices/system/cpu/" + name + "/cpufreq/scaling_governor");
    if (governor.empty()) continue;
    ++found;
    if (governor != "performance") others.push_back(name + " (" + governor + ")");
  }
  std::sort(others.begin(), others.end());
  return others;
}

int countProcessors(const Machine& machine) {
  int count = 0;
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(machine.root / "sys/devices/system/cpu", ignored)) {
    const std::string name = entry.path().filename();
    count += name.size() > 3 && name.starts_with("cpu") &&
             name.find_first_not_of("0123456789", 3) == std::string::npos;
  }
  return count;
}

double microseconds(Duration d) { return toSeconds(d) * 1e6; }

}  // namespace

Finding checkPriority(const Machine& machine) {
  // 0 means that no real-time thread may run at all; the kernel's default leaves 95 %.
  if (firstLine(machine, "proc/sys/kernel/sched_rt_runtime_us") == "0") {
    return {kProblem, "the kernel gives real-time threads no time",
            "kernel.sched_rt_runtime_us = 950000",
            "sudo sysctl -w kernel.sched_rt_runtime_us=950000"};
  }
  if (hasCapability(machine, kCapSysNice)) return {kOk, "any priority (CAP_SYS_NICE)"};
  const auto limit = softLimit(machine, "Max realtime priority");
  if (limit && (*limit < 0 || *limit >= kWantedPriority))
    return {kOk, *limit < 0 ? "any priority" : fmt::format("SCHED_FIFO up to {}", *limit)};
  return {kProblem, limit ? fmt::format("SCHED_FIFO up to {}", *limit) : "no limit known",
          fmt::format("at least {}", kWantedPriority), kJoinGroup};
}

Finding checkMemlock(const Machine& machine) {
  if (hasCapability(machine, kCapIpcLock)) return {kOk, "any amount (CAP_IPC_LOCK)"};
  const auto limit = softLimit(machine, "Max locked memory");
  if (limit && *limit < 0) return {kOk, "unlimited"};
  if (limit && *limit >= kWantedMemlock) return {kOk, fmt::format("{} MiB", *limit >> 20)};
  return {kProblem, limit ? fmt::format("{} KiB", *limit >> 10) : "no limit known", "unlimited",
          kJoinGroup};
}

Finding checkKernel(const Machine& machine) {
  const std::string release = firstLine(machine, "proc/sys/kernel/osrelease");
  if (firstLine(machine, "sys/kernel/realtime") == "1") return {kOk, release + ", PREEMPT_RT"};
  const std::string arch =
      firstLine(machine, "proc/sys/kernel/arch") == "aarch64" ? "arm64" : "amd64";
  return {kAdvice, release + ", not PREEMPT_RT", "PREEMPT_RT",
          "sudo apt-get install linux-image-rt-" + arch + " && sudo reboot"};
}

Finding checkGovernor(const Machine& machine) {
  int found = 0;
  const auto others = otherGovernors(machine, found);
  if (found == 0) return {kOk, "no frequency scaling on this machine"};
  if (others.empty()) return {kOk, fmt::format("performance on all {} processors", found)};
  return {kProblem, fmt::format("{}", fmt::join(others, ", ")), "performance",
          "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor (for "
          "good: sudo systemctl enable --now tautline-governor.service)"};
}

Finding checkClockSource(const Machine& machine) {
  constexpr std::array<std::string_view, 4> kFast{"tsc", "arch_sys_counter", "kvm-clock",
                                                  "hyperv_clocksource_tsc_page"};
  const std::string folder = "sys/devices/system/clocksource/clocksource0/";
  const std::string current = firstLine(machine, folder + "current_clocksource");
  if (std::find(kFast.begin(), kFast.end(), current) != kFast.end()) return {kOk, current};
  const std::string available = firstLine(machine, folder + "available_clocksource") + ' ';
  for (const std::string_view fast : kFast) {
    if (!available.starts_with(std::string(fast) + ' ') &&
        available.find(' ' + std::string(fast) + ' ') == std::string::npos)
      continue;
    return {kProblem, current, std::string(fast),
            fmt::format("echo {} | sudo tee /{}current_clocksource", fast, folder)};
  }
  return {kProblem, current.empty() ? "unknown" : current,
          fmt::format("one of {}", fmt::join(kFast, ", ")),
          "journalctl -k --grep clocksource (says why the kernel gave the fast one up)"};
}

Finding checkClockSynchronized(const Machine& machine) {
  if (machine.clock_synchronized && machine.clock_synchronized()) return {kOk, "synchronized"};
  return {kAdvice, "the wall clock is not synchronized; logs carry its time", "synchronized",
          "sudo timedatectl set-ntp true (without a network: sudo timedatectl set-time 'YYYY-MM-DD "
          "hh:mm:ss')"};
}

Finding checkIsolatedCpus(const Machine& machine) {
  const std::string isolated = firstLine(machine, "sys/devices/system/cpu/isolated");
  if (!isolated.empty())
    return {kOk, "processor " + isolated + "; realtime_cpu in station.toml must name one of them"};
  const int processors = countProcessors(machine);
  if (processors < 3) return {kOk, fmt::format("none, and only {} processors", processors)};
  const int last = processors - 1;
  const bool pi = fs::exists(machine.root / "boot/firmware/cmdline.txt");
  const std::string words = fmt::format("isolcpus={0} nohz_full={0} rcu_nocbs={0}", last);
  const std::string command =
      pi ? fmt::format("sudo sed -i '1s/$/ {}/' /boot/firmware/cmdline.txt && sudo reboot", words)
         : fmt::format(
               "echo 'GRUB_CMDLINE_LINUX=\"$GRUB_CMDLINE_LINUX {}\"' | sudo tee "
               "/etc/default/grub.d/tautline.cfg && sudo update-grub && sudo reboot",
               words);
  return {kAdvice, "none",
          fmt::format("processor {0}, and realtime_cpu = {0} in station.toml", last), command};
}

Finding checkLatency(const Machine& machine) {
  const Duration period = fromSeconds(1.0 / machine.loop_rate_hz);
  if (!machine.lateness) return {kProblem, "not measured", "a measurement", "tautline doctor --rt"};
  const std::vector<Duration> lateness = machine.lateness(period, fromSeconds(machine.latency_s));
  std::vector<Duration> sorted = lateness;
  std::sort(sorted.begin(), sorted.end());
  const Duration p99 = quantile(sorted, 0.99);
  const auto missed =
      std::count_if(sorted.begin(), sorted.end(), [&](Duration d) { return d > period; });
  const Duration allowed = fromSeconds(toSeconds(period) * kLatencyShare);
  Finding finding;
  finding.measured = fmt::format(
      "{} cycles at {:g} Hz: p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, max {:.0f} us late, {} missed",
      sorted.size(), machine.loop_rate_hz, microseconds(quantile(sorted, 0.5)), microseconds(p99),
      microseconds(quantile(sorted, 0.999)), microseconds(sorted.back()), missed);
  finding.details = latencyHistogram(lateness);
  if (p99 <= allowed &&
      static_cast<double>(missed) <= kMissedShare * static_cast<double>(sorted.size()))
    return finding;
  finding.status = kProblem;
  finding.wanted = fmt::format("p99 within {:.0f} us", microseconds(allowed));
  finding.remedy =
      "mend what is named above first; then see who else runs: top -H -o %CPU, and cat "
      "/proc/interrupts";
  return finding;
}

}  // namespace tautline::cli
