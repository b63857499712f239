#pragma once

/// @file
/// Importer of the two text forms in which earlier software kept its paths (docs/mission_files.md,
/// "Legacy files"):
///
///   9 numbers a line   x y z  poi_x poi_y poi_z  contact_x contact_y contact_z    metres, axes of
///   W 6 numbers a line   x y z  contact_x contact_y contact_z                       planner's
///   voxels, its axes (z, x, y of W)
///
/// The contact column holds the active anchor; the reel stands there as 0 0 0 (9 numbers) or 0.01
/// 0.01 0.01 (6 numbers; either value is understood in both). Distinct contact points become
/// contact ids 1, 2, … in order of first appearance. A point of interest 0 0 0 means none.
/// Positions are scaled and permuted, never shifted. LF or CRLF, with or without a newline at the
/// end; blank lines and comments (# or % to the end of the line) are skipped. Not real-time safe:
/// start-up only.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/mission/mission_file.h"

namespace tautline {

/// Which column of the file, with which sign, becomes x, y and z of W.
struct LegacyAxes {
  std::array<int, 3> column{0, 1, 2};
  std::array<double, 3> sign{1.0, 1.0, 1.0};
};

/// "xyz" = as in the file; "yzx" = our x is the file's y, our y its z, our z its x; "-" before a
/// letter negates it. Throws InputError unless each letter appears once.
[[nodiscard]] LegacyAxes parseLegacyAxes(std::string_view text);

struct LegacyOptions {
  std::string name;  ///< Of the mission; empty: the file's name without extension.
  std::optional<double>
      scale;  ///< [m] per unit of the file; absent: 1 (9 numbers) or 0.33 (6 numbers).
  std::optional<LegacyAxes> axes;  ///< Absent: xyz (9 numbers) or yzx (6 numbers).
};

/// Throws InputError with file and line: not 6 or 9 numbers, or not as many as the first row;
/// anything that is not a finite number; no rows or too many; an impossible contact order.
[[nodiscard]] Mission importLegacyMission(const std::filesystem::path& path,
                                          const LegacyOptions& options = {});

/// `name` stands for the file in errors.
[[nodiscard]] Mission parseLegacyMission(std::string_view text, const std::string& name,
                                         const LegacyOptions& options = {});

}  // namespace tautline
