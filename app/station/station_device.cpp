#include "app/station/station_device.h"

#include <utility>

#include "app/station/emulated_machine.h"
#include "app/station/replay_device.h"
#include "common/error.h"
#include "drivers/can_socket.h"
#include "drivers/cobs_port.h"
#include "drivers/fotokite_device.h"
#include "drivers/serial_port.h"
#include "drivers/tautline_device.h"

namespace tautline {
namespace {

/// A bench must never move a real machine, whatever is plugged in later.
bool benchOnly(const StationConfig& config) {
  return config.run_mode != RunMode::kReal && !thisMachineHasEmulatedUart();
}

/// Keeps the reason for people, or ends the program where going on would be dangerous.
template <class Result>
std::string warningOf(const Result& opened, bool refused) {
  if (refused) throw InputError({.problem = opened.reason}, ExitCode::kRefused);
  return opened.reason;
}

SerialPort& openSerial(const StationConfig& config, StationDevice& out) {
  SerialConfig serial = config.serial;
  serial.pseudo_terminal_only = benchOnly(config);
  auto port = std::make_unique<SerialPort>(serial);
  const SerialOpenResult opened = port->open();
  out.warning = warningOf(opened, opened.status == SerialStatus::kRealDevice);
  SerialPort& made = *port;
  out.bytes = std::move(port);
  out.serial = &made;
  return made;
}

void openCan(const StationConfig& config, StationDevice& out) {
  CanConfig can = config.can;
  can.virtual_only = benchOnly(config);
  auto port = std::make_unique<CanSocket>(can, kTautlineIds);
  const CanOpenResult opened = port->open();
  out.warning = warningOf(opened, opened.status == CanStatus::kRealDevice);
  out.frames = std::move(port);
}

}  // namespace

std::string& placeOf(StationConfig& config) noexcept {
  switch (config.device) {
    case DeviceKind::kTautlineCan:
      return config.can.interface;
    case DeviceKind::kReplay:
      return config.replay.file;
    case DeviceKind::kFotokite:
    case DeviceKind::kTautlineSerial:
      break;
  }
  return config.serial.device;
}

DeviceReality StationDevice::reality() const noexcept {
  if (serial == nullptr || !judged) return DeviceReality::kUnknown;
  if (serial->status() == SerialStatus::kRealDevice) return DeviceReality::kReal;
  if (!serial->connected()) return DeviceReality::kUnknown;
  return serial->isPseudoTerminal() ? DeviceReality::kEmulated : DeviceReality::kReal;
}

StationDevice makeDevice(const StationConfig& config) {
  StationDevice out;
  out.judged = !thisMachineHasEmulatedUart();
  StationConfig named = config;
  out.place = placeOf(named);
  const char* const name = nameOf(config.device, kDeviceKindNames);
  switch (config.device) {
    case DeviceKind::kFotokite:
      out.device = std::make_unique<FotokiteDevice>(openSerial(config, out), config.fotokite);
      break;
    case DeviceKind::kTautlineSerial:
      out.frames = std::make_unique<CobsPort>(openSerial(config, out));
      out.device = std::make_unique<TautlineDevice>(*out.frames, config.tautline, name);
      break;
    case DeviceKind::kTautlineCan:
      openCan(config, out);
      out.device = std::make_unique<TautlineDevice>(*out.frames, config.tautline, name);
      break;
    case DeviceKind::kReplay:
      out.device =
          std::make_unique<ReplayDevice>(readRecording(config.replay.file), config.replay.speed);
      break;
  }
  return out;
}

}  // namespace tautline
