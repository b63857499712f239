#pragma once

/// @file
/// The vehicle's flag bits by name; which names they have depends on the device.

#include <string>
#include <vector>

#include "app/cli/station_client.h"

namespace tautline::cli::flight {

/// Names of the flags that are set, or their number where the device is not known.
/// Pre-condition: a vehicle state has come.
[[nodiscard]] std::vector<std::string> flagNames(const StationClient::View& view);

}  // namespace tautline::cli::flight
