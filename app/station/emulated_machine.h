#pragma once

/// @file
/// A bench may move nothing real, so it takes only a pseudo terminal as its serial device and only
/// a virtual CAN interface. The one exception is a machine that is emulated as a whole: its UART,
/// and a CAN adapter on it, are real devices to the kernel inside, and end in the simulator outside
/// (docs/emulated_pi.md).

#include <string_view>

namespace tautline {

/// The word on the kernel's command line by which the emulator says so. It belongs to the machine,
/// not to a config file, so that no file that is copied to a real one can carry it along.
inline constexpr std::string_view kEmulatedUartWord = "tautline.emulated_uart";

/// True if the whole word stands in a kernel's command line.
[[nodiscard]] bool hasEmulatedUart(std::string_view kernel_command_line) noexcept;

/// The same for the kernel that this runs on; false where it cannot be read. Not real-time safe:
/// start-up only.
[[nodiscard]] bool thisMachineHasEmulatedUart();

}  // namespace tautline
