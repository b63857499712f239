#pragma once

/// @file
/// Can this mission be flown? Checks of a valid mission (mission_file.h) that need limits, the
/// tether model or a scene. Not real-time safe: start-up only.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/fields.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"

namespace tautline {

enum class FindingSeverity : std::uint8_t {
  kError,    ///< Do not fly.
  kWarning,  ///< Flyable, probably not what was meant.
  kInfo,     ///< Worth knowing.
};
inline constexpr std::array<EnumName<FindingSeverity>, 3> kFindingSeverityNames{
    {{FindingSeverity::kError, "error"},
     {FindingSeverity::kWarning, "warning"},
     {FindingSeverity::kInfo, "info"}}};

struct MissionFinding {
  FindingSeverity severity{FindingSeverity::kInfo};
  std::string row;     ///< "waypoints[3]", "contacts[0]"; empty: the whole mission.
  std::string text;    ///< What was found, with its numbers.
  std::string remedy;  ///< What to do about it; empty for information.
};

/// What the vehicle and its operator can do. Lengths [m], angles [rad], forces [N].
struct MissionLimits {
  double tether_length_max{10.0};
  double tether_length_min{0.3};
  double first_elevation_min{0.1};
  double first_elevation_max{1.5};
  double tension{0.3};
  double tether_density{0.0061};
  double floor_margin{0.1};
  double anchor_margin{0.25};
  double obstacle_margin{0.3};
  double tether_cut{0.03};
  double switch_jump{0.1};
  double pole_radius{0.3};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("tether_length_max_m", tether_length_max, Range{0.1, 1000.0}, "tether on the reel");
    v.field("tether_length_min_m", tether_length_min, Range{0.0, 100.0},
            "shortest free tether that can be held");
    v.field("first_elevation_min_rad", first_elevation_min, Range{-1.5, 1.5},
            "of the first waypoint, seen from the reel");
    v.field("first_elevation_max_rad", first_elevation_max, Range{-1.5, 1.57},
            "of the first waypoint, seen from the reel");
    v.field("tension_n", tension, Range{0.01, 100.0}, "nominal tether tension at the drone");
    v.field("tether_density_kg_per_m", tether_density, Range{0.0, 1.0}, "mass per length");
    v.field("floor_margin_m", floor_margin, Range{0.0, 10.0},
            "drone above the floor and below the ceiling");
    v.field("anchor_margin_m", anchor_margin, Range{0.0, 10.0},
            "drone to the reel outlet or active contact");
    v.field("obstacle_margin_m", obstacle_margin, Range{0.0, 10.0}, "drone to obstacles and walls");
    v.field("tether_cut_m", tether_cut, Range{0.0, 1.0},
            "how deep the straight tether may cut into an obstacle");
    v.field("switch_jump_m", switch_jump, Range{0.0, 10.0},
            "change of tether length when a contact is formed or relaxed");
    v.field("pole_radius_m", pole_radius, Range{0.0, 10.0},
            "nearer to the vertical above the anchor is a pole crossing");
  }
};

/// The scene that belongs to a mission: the file given, else the mission's own map if that is a
/// scene (relative to the mission file's folder), else nothing. Throws InputError if it cannot be
/// read.
[[nodiscard]] std::optional<Scene> findScene(const Mission& mission,
                                             const std::filesystem::path& mission_file,
                                             const std::string& scene_file = "");

/// All findings in the order of the rows. Without a scene the floor is at W height -reel_position.y
/// and there are no obstacles. `scene` is in M, as read from its file.
[[nodiscard]] std::vector<MissionFinding> checkMission(const Mission& mission,
                                                       const MissionLimits& limits,
                                                       const Scene* scene = nullptr);

/// True if no finding is an error.
[[nodiscard]] bool isFlyable(const std::vector<MissionFinding>& findings) noexcept;

/// Largest depth to which the straight line p-q cuts into any obstacle [m], >= 0, sampled every 1
/// cm; `obstacle` (optional) gets the name of that obstacle.
[[nodiscard]] double cutDepth(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                              const Scene& scene, std::string* obstacle = nullptr);

}  // namespace tautline
