#pragma once

/// @file
/// Timed stick rates from a file, in place of a keyboard. One row a line:
/// `seconds dead_man length elevation azimuth yaw gimbal`, `#` begins a comment.

#include <optional>
#include <string>
#include <vector>

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline::cli::flight {

struct StickRow {
  Duration lasts{};
  bool dead_man{false};
  TeleopRates rates;
};

/// @throws InputError with file and line.
[[nodiscard]] std::vector<StickRow> readStickScript(const std::string& file);

/// The row that counts at `since_start`; none after the last.
[[nodiscard]] std::optional<StickRow> rowAt(const std::vector<StickRow>& rows,
                                            Duration since_start);

}  // namespace tautline::cli::flight
