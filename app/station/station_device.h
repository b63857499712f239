#pragma once

/// @file
/// The device that the configuration asks for, with the port it stands on.

#include <memory>
#include <string>

#include "app/station/station_config.h"
#include "drivers/bus_frame.h"
#include "drivers/byte_port.h"
#include "drivers/device.h"

namespace tautline {

struct StationDevice {
  std::unique_ptr<BytePort> bytes;    ///< Serial devices only.
  std::unique_ptr<FramePort> frames;  ///< Devices on the Tautline bus only.
  std::unique_ptr<Device> device;     ///< Never null; goes first.
  std::string place;                  ///< Path, interface or file, for people.
  std::string warning;                ///< Why it is not open yet and what to do; empty if it is.
};

/// Opens the port. One that cannot be opened is tried again by the loop: a device that is plugged
/// in later must not need a restart. @throws InputError (kRefused) for a real device where
/// `run_mode` forbids it, or for a recording that cannot be read. Not real-time safe: start-up
/// only.
[[nodiscard]] StationDevice makeDevice(const StationConfig& config);

/// Path, interface or file of the chosen device, to be set or shown.
[[nodiscard]] std::string& placeOf(StationConfig& config) noexcept;

}  // namespace tautline
