#pragma once

/// @file
/// Checks of what a station needs around it: its config, its device, LCM, room on the disk. They
/// look at the machine itself, through the code that the station uses. Not real-time safe.

#include "app/cli/doctor/check.h"

namespace tautline::cli {

/// The config file can be read and has nothing wrong in it.
[[nodiscard]] Finding checkConfig(const Machine& machine);

/// The serial port of the config is there, ours to use and free. Opens it for a moment; a port that
/// a running station holds is left alone.
[[nodiscard]] Finding checkSerialPort(const Machine& machine);

/// The CAN interface of the config is there, up, on the bus, and has the bit rate of
/// /etc/tautline/can.conf.
[[nodiscard]] Finding checkCan(const Machine& machine);

/// LCM's packets have a way.
[[nodiscard]] Finding checkMulticast(const Machine& machine);

/// Whether a station is heard; none is no problem.
[[nodiscard]] Finding checkStationHeard(const Machine& machine);

/// Room for two hours of logs.
[[nodiscard]] Finding checkLogDisk(const Machine& machine);

/// Room for the black box, unless it is there already.
[[nodiscard]] Finding checkBlackBoxDisk(const Machine& machine);

/// What `ip -details -json link show` (its whole output) says of an interface that is up, judged:
/// on the bus, and with `wanted_bitrate` [bit/s]. Virtual interfaces have neither.
[[nodiscard]] Finding judgeCanLink(const std::string& ip_output, const std::string& interface,
                                   int wanted_bitrate);

}  // namespace tautline::cli
