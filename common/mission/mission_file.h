#pragma once

/// @file
/// Mission files (`*.mission.toml`, docs/mission_files.md): strict reader, atomic writer, canonical
/// text and hash. Not real-time safe: start-up only.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "common/mission_plan.h"

namespace tautline {

inline constexpr int kMissionFileVersion = 1;
inline constexpr double kMaxMissionSpeed = 5.0;          ///< [m/s]
inline constexpr double kMaxMissionHold = 3600.0;        ///< [s]
inline constexpr double kMaxMissionCoordinate = 1000.0;  ///< Of any point [m].

/// A mission and what belongs to its file. Move-only: the plan is large and lives on the heap,
/// never null.
struct Mission {
  std::string name;
  std::string description;
  std::string frame{"W"};  ///< Of all positions; W is the only one there is.
  Eigen::Vector3d reel_position{
      Eigen::Vector3d::Zero()};  ///< Reel outlet in the map frame M [m]: p_M = p_W + this.
  std::string map;       ///< Map or scene it was planned in, relative to its folder; may be empty.
  std::string map_hash;  ///< hashText(fnv1a(bytes of that file)); may be empty.
  std::unique_ptr<MissionPlan> plan{std::make_unique<MissionPlan>()};
};

/// Throws InputError with file, line and row. Sets plan->hash.
[[nodiscard]] Mission readMission(const std::filesystem::path& path);

/// `name` stands for the file in errors.
[[nodiscard]] Mission parseMission(std::string_view text, const std::string& name);

/// What the reader checks beyond the syntax: number of waypoints, finite numbers in range, contact
/// ids unique and > 0, every waypoint's contact exists, no contact pushed onto an anchor at the
/// same place. Throws InputError whose key names the row.
void validateMission(const Mission& mission);

/// The mission as text, the same for the same mission: fixed order of keys, one waypoint a line,
/// numbers with the fewest digits that read back to the same bits, "\n" line ends. This is what
/// writeMission() writes.
[[nodiscard]] std::string canonicalText(const Mission& mission);

/// FNV-1a, 64 bit, of the canonical text.
[[nodiscard]] std::uint64_t missionHash(const Mission& mission);

/// FNV-1a, 64 bit (Fowler, Noll, Vo): offset basis 0xcbf29ce484222325, prime 0x100000001b3.
[[nodiscard]] std::uint64_t fnv1a(std::string_view bytes) noexcept;

/// The hash as it is shown everywhere: 16 hexadecimal digits.
[[nodiscard]] std::string hashText(std::uint64_t hash);

/// Validates, then writes the canonical text atomically: nothing half-written, ever. Throws
/// InputError. Sets plan->hash.
void writeMission(Mission& mission, const std::filesystem::path& path);

/// The contact stack on the way to each waypoint: contact ids from the reel (not listed) to the
/// active anchor; empty = reel. A waypoint's contact that is in the stack pops what lies above it;
/// one that is not is pushed.
[[nodiscard]] std::vector<std::vector<int>> contactStacks(const MissionPlan& plan);

/// Position of a contact [m] in W; the origin for the reel. The id must exist in the plan.
[[nodiscard]] Eigen::Vector3d anchorPosition(const MissionPlan& plan, int contact_id);

/// Tether along the contacts of a stack, reel to active anchor [m].
[[nodiscard]] double staticLength(const MissionPlan& plan, const std::vector<int>& stack);

}  // namespace tautline
