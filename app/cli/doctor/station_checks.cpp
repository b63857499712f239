#include "app/cli/doctor/station_checks.h"

#include <grp.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <tautline/station_state_t.hpp>

#include "app/station/black_box.h"
#include "app/station/emulated_machine.h"
#include "app/station/station_config.h"
#include "common/clock.h"
#include "common/multicast.h"
#include "drivers/can_socket.h"
#include "drivers/serial_holder.h"
#include "drivers/serial_port.h"
#include "drivers/tautline_device.h"
#include "lcmtypes/channels.h"
#include "supervision/supervisor.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;
using enum FindingStatus;

constexpr std::uint64_t kMiB = 1ULL << 20U;
constexpr std::uint64_t kLogRoom = 512 * kMiB;  // two hours at 100 Hz
constexpr std::uint64_t kBlackBoxSize = sizeof(CycleRecord) * BlackBox::kCapacity;
constexpr Duration kListen = std::chrono::milliseconds(1500);
constexpr const char* kNoConfig = "not looked at: no readable config (--config FILE)";
constexpr int kDefaultBitrate = 500'000;

bool usesSerial(const Machine& machine) {
  return machine.config && (machine.config->device == DeviceKind::kFotokite ||
                            machine.config->device == DeviceKind::kTautlineSerial);
}
bool usesCan(const Machine& machine) {
  return machine.config && machine.config->device == DeviceKind::kTautlineCan;
}

/// As the station itself decides it.
bool benchOnly(const StationConfig& config) {
  return config.run_mode != RunMode::kReal && !thisMachineHasEmulatedUart();
}

/// A check that has nothing to look at.
Finding notUsed(const Machine& machine, const char* what) {
  return {kOk, machine.config ? std::string("the config uses no ") + what : kNoConfig};
}

/// What gives the user that runs this the right to read and write `device`.
std::string accessRemedy(const std::string& device) {
  struct stat status {};
  if (::stat(device.c_str(), &status) != 0)
    return "sudo chmod o+x \"$(dirname \"$(realpath " + device + ")\")\"";
  constexpr mode_t kGroup = S_IRGRP | S_IWGRP;
  const group* owner = ::getgrgid(status.st_gid);
  if ((status.st_mode & kGroup) != kGroup || owner == nullptr || status.st_gid == 0)
    return "sudo chgrp tautline " + device + " && sudo chmod g+rw " + device;
  return fmt::format("sudo usermod --append --groups {} \"$USER\", then log in again",
                     owner->gr_name);
}

/// Remedy for what open() found.
std::string serialRemedy(const SerialConfig& config, SerialStatus status,
                         const fs::path& config_file) {
  switch (status) {
    case SerialStatus::kPermission:
      return accessRemedy(config.device);
    case SerialStatus::kBusy:
      return "sudo fuser --kill -TERM " + config.device;
    case SerialStatus::kRealDevice:
      return fmt::format("sudo sed -i 's/^run_mode.*/run_mode = \"REAL\"/' {}",
                         config_file.string());
    default:
      return fmt::format("ls /dev/serial/by-id/; sudo editor {}   # serial.device",
                         config_file.string());
  }
}

std::string bringUp(const std::string& interface, int bitrate) {
  return fmt::format("sudo ip link set {} up type can bitrate {} restart-ms 100", interface,
                     bitrate);
}

std::string canRemedy(const CanConfig& config, CanStatus status, int bitrate) {
  switch (status) {
    case CanStatus::kNoCan:
      return "sudo modprobe can-raw";
    case CanStatus::kDown:
      return config.virtual_only ? fmt::format("sudo ip link set {} up", config.interface)
                                 : bringUp(config.interface, bitrate);
    default:
      return "ip -brief link show type can; sudo editor /etc/tautline/station.toml   # "
             "can.interface";
  }
}

/// What a command says on stdout; empty if it cannot be run.
std::string outputOf(const std::string& command) {
  const auto close = [](FILE* pipe) { ::pclose(pipe); };
  const std::unique_ptr<FILE, decltype(close)> pipe(::popen(command.c_str(), "r"), close);
  std::string out;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 1; pipe && n > 0;) {
    n = std::fread(buffer.data(), 1, buffer.size(), pipe.get());
    out.append(buffer.data(), n);
  }
  return out;
}

/// CAN_BITRATE of can.conf; what tautline-can@.service sets without it.
int configuredBitrate(const Machine& machine) {
  std::ifstream in(machine.root / "etc/tautline/can.conf");
  constexpr std::string_view kKey = "CAN_BITRATE=";
  for (std::string line; std::getline(in, line);) {
    int value = 0;
    if (line.starts_with(kKey) &&
        std::from_chars(line.data() + kKey.size(), line.data() + line.size(), value).ec ==
            std::errc())
      return value;
  }
  return kDefaultBitrate;
}

Finding roomOn(const fs::path& folder, std::uint64_t wanted, const std::string& remedy) {
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) != 0) {
    return {kProblem, fmt::format("{}: {}", folder.string(), std::strerror(errno)), "a folder",
            fmt::format("sudo install -d -o tautline -g tautline {}", folder.string())};
  }
  const std::uint64_t free = std::uint64_t{disk.f_bavail} * disk.f_frsize;
  const std::string measured = fmt::format("{} MiB free in {}", free / kMiB, folder.string());
  if (free >= wanted) return {kOk, measured};
  return {kProblem, measured, fmt::format("at least {} MiB", (wanted + kMiB - 1) / kMiB), remedy};
}

/// Hears one STATION_STATE.
class StateEar {
 public:
  void onState(const lcm::ReceiveBuffer*, const std::string&, const tautline::station_state_t* m) {
    state_ = *m;
  }
  [[nodiscard]] const std::optional<tautline::station_state_t>& state() const { return state_; }

 private:
  std::optional<tautline::station_state_t> state_;
};

}  // namespace

Finding checkConfig(const Machine& machine) {
  if (machine.config) return {kOk, machine.config_file.string() + " is right"};
  if (machine.config_file.empty()) return {kOk, kNoConfig};
  return {kProblem, machine.config_problem, "a config without errors",
          fmt::format("sudo editor {} && tautline-station --config {} --check-config",
                      machine.config_file.string(), machine.config_file.string())};
}

Finding checkSerialPort(const Machine& machine) {
  if (!usesSerial(machine)) return notUsed(machine, "serial port");
  SerialConfig config = machine.config->serial;
  config.pseudo_terminal_only = benchOnly(*machine.config);
  const SerialOpenResult opened = SerialPort(config).open();
  if (opened) return {kOk, config.device + " opens at " + std::to_string(config.baud) + " baud"};
  if (opened.status == SerialStatus::kBusy) {
    const std::string holder = describeHolder(config.device);
    if (holder.starts_with("tautline-statio"))  // what the kernel keeps of the name
      return {kOk, config.device + " is in use by " + holder};
  }
  return {kProblem, opened.reason, "a serial port that this user can open",
          serialRemedy(config, opened.status, machine.config_file)};
}

Finding checkCan(const Machine& machine) {
  if (!usesCan(machine)) return notUsed(machine, "CAN interface");
  CanConfig config = machine.config->can;
  config.virtual_only = benchOnly(*machine.config);
  const CanOpenResult opened = CanSocket(config, kTautlineIds).open();
  if (!opened)
    return {kProblem, opened.reason, "a CAN interface that is up",
            canRemedy(config, opened.status, configuredBitrate(machine))};
  return judgeCanLink(outputOf("ip -details -json link show dev " + config.interface),
                      config.interface, configuredBitrate(machine));
}

Finding judgeCanLink(const std::string& ip_output, const std::string& interface,
                     int wanted_bitrate) {
  const auto json = nlohmann::json::parse(ip_output, nullptr, false);
  const nlohmann::json link = json.is_array() && !json.empty() ? json[0] : nlohmann::json::object();
  const nlohmann::json info = link.value("linkinfo", nlohmann::json::object());
  const std::string kind = info.value("info_kind", "unknown");
  const nlohmann::json can = info.value("info_data", nlohmann::json::object());
  if (kind == "vcan" || kind == "vxcan") return {kOk, interface + " is up, virtual (" + kind + ")"};
  const std::string again =
      fmt::format("sudo ip link set {} down && {}", interface, bringUp(interface, wanted_bitrate));
  const std::string state = can.value("state", "unknown");
  const int bitrate = can.value("bittiming", nlohmann::json::object()).value("bitrate", 0);
  const std::string measured = fmt::format("{} is up, {}, {} bit/s", interface, state, bitrate);
  if (state == "BUS-OFF" || state == "STOPPED")
    return {kProblem, measured, "state ERROR-ACTIVE; look for a short circuit or swapped wires",
            again};
  if (bitrate == 0)
    return {kAdvice, interface + " is up, bit rate unknown",
            fmt::format("{} bit/s", wanted_bitrate), again};
  if (bitrate != wanted_bitrate)
    return {kProblem, measured, fmt::format("{} bit/s (/etc/tautline/can.conf)", wanted_bitrate),
            again};
  if (state != "ERROR-ACTIVE")
    return {kAdvice, measured, "state ERROR-ACTIVE: another node that acknowledges, terminators",
            "ip -details -statistics link show " + interface};
  return {kOk, measured};
}

Finding checkMulticast(const Machine& machine) {
  if (hasMulticastRoute(machine.lcm_url)) return {kOk, "there is a route for " + machine.lcm_url};
  return {kProblem, "no route for " + machine.lcm_url, "a multicast route",
          "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"};
}

Finding checkStationHeard(const Machine& machine) {
  if (!hasMulticastRoute(machine.lcm_url)) return {kOk, "not listened for: no multicast route"};
  lcm::LCM lcm(machine.lcm_url);
  if (!lcm.good()) return {kOk, "not listened for: LCM cannot join " + machine.lcm_url};
  StateEar ear;
  lcm.subscribe(channel::kStationState, &StateEar::onState, &ear);
  for (const Time end = monotonicNow() + kListen; !ear.state() && monotonicNow() < end;)
    lcm.handleTimeout(100);
  if (!ear.state()) return {kOk, "none heard (no problem: it may not be running)"};
  return {kOk, fmt::format("heard, run mode {}, mode {}",
                           nameOf(static_cast<RunMode>(ear.state()->run_mode), kRunModeNames),
                           nameOf(static_cast<Mode>(ear.state()->mode), kModeNames))};
}

Finding checkLogDisk(const Machine& machine) {
  return roomOn(machine.log_folder, kLogRoom,
                fmt::format("sudo apt-get clean && sudo journalctl --vacuum-size=50M; what else is "
                            "large: du -xah {} | sort -h | tail",
                            machine.log_folder.string()));
}

Finding checkBlackBoxDisk(const Machine& machine) {
  const fs::path box = machine.config ? machine.config->black_box : StationConfig{}.black_box;
  if (box.empty()) return {kOk, "the config has no black box"};
  std::error_code ignored;
  const std::uintmax_t there = fs::exists(box, ignored) ? fs::file_size(box, ignored) : 0;
  if (there >= kBlackBoxSize) return {kOk, box.string() + " is there already"};
  return roomOn(box.parent_path(), kBlackBoxSize - there,
                fmt::format("sudo mount -o remount,size={}M {}", 4 * kBlackBoxSize / kMiB,
                            box.parent_path().string()));
}

}  // namespace tautline::cli
