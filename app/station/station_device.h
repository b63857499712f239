#pragma once

/// @file
/// The device that the configuration asks for, with the port it stands on.

#include <memory>
#include <string>

#include "app/station/station_config.h"
#include "drivers/bus_frame.h"
#include "drivers/byte_port.h"
#include "drivers/device.h"
#include "drivers/serial_port.h"
#include "supervision/detect/host_watch.h"

namespace tautline {

struct StationDevice {
  std::unique_ptr<BytePort> bytes;    ///< Serial devices only.
  std::unique_ptr<FramePort> frames;  ///< Devices on the Tautline bus only.
  std::unique_ptr<Device> device;     ///< Never null; goes first.
  std::string place;                  ///< Path, interface or file, for people.
  std::string warning;                ///< Why it is not open yet and what to do; empty if it is.
  const SerialPort* serial{};         ///< Of a serial device: the port behind `bytes`.
  bool judged{true};  ///< False on an emulated machine, whose devices look real from inside.

  /// Whether what is plugged in now can move. A CAN interface does not tell. Real-time safe: no
  /// allocation, no locks, no exceptions.
  [[nodiscard]] DeviceReality reality() const noexcept;
};

/// Opens the port. One that cannot be opened is tried again by the loop: a device that is plugged
/// in later must not need a restart. @throws InputError (kRefused) for a real device where
/// `run_mode` forbids it, or for a recording that cannot be read. Not real-time safe: start-up
/// only.
[[nodiscard]] StationDevice makeDevice(const StationConfig& config);

/// Path, interface or file of the chosen device, to be set or shown.
[[nodiscard]] std::string& placeOf(StationConfig& config) noexcept;

}  // namespace tautline
