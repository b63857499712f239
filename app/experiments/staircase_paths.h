#pragma once

/// @file
/// The two viewpoints of the staircase (dissertation chapter 7), the paths to them and who flies
/// them. Not real-time safe.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/experiments/flight_campaign.h"
#include "app/experiments/planned_path.h"
#include "app/experiments/setup.h"
#include "common/plot/figure.h"
#include "planning_offline/cli/workspace.h"

namespace tautline::experiments {

struct Viewpoint {
  const char* name;
  Eigen::Vector3d goal;  // M [m]
  double reward;
  // Published, chapter 7: risk, utility, and successes of ten trials.
  double risk;
  double utility;
  int successes;
  double wanted;  // of our success
  plot::Colour colour;
};
inline const std::array kViewpoints{
    Viewpoint{"red", {5.0, 0.6, 4.2}, 1.0, 0.714, 1.401, 2, 0.85, plot::Colour::kVermilion},
    Viewpoint{"green", {3.8, 2.6, 1.4}, 0.9, 0.575, 1.565, 4, 0.95, plot::Colour::kGreen}};
inline constexpr int kPublishedTrials = 10;

inline constexpr std::array kStairStations{"as published", "ours"};

/// Of each station and viewpoint.
using StairTallies =
    std::array<std::array<CampaignTally, kViewpoints.size()>, kStairStations.size()>;

/// Map, planned paths, and who flies them.
struct Stairs {
  planning::RiskSpace space;
  std::array<PlannedPath, kViewpoints.size()> paths;
  /// [station][viewpoint]; their missions are those of `paths`.
  std::array<std::array<CampaignFlight, kViewpoints.size()>, kStairStations.size()> flights;
};
[[nodiscard]] std::shared_ptr<const Stairs> planStairs(const Setup& setup);

/// The published software as it flew there: all of the low-level motion suite, so with the
/// corrected localizer, and position control.
[[nodiscard]] StationConfig publishedDemonstration(const Setup& setup);

/// Some flights: how each ended and, on request, its way.
struct StairTrial {
  std::uint64_t seed{1};  ///< Of the first.
  std::int64_t flights{1};
  bool tracks{false};
  std::optional<double> pull{};  ///< On the tether, other than the plant's [N].
};
[[nodiscard]] nlohmann::json flyStairs(const CampaignFlight& flight, const StairTrial& trial);
/// Adds what flyStairs() returned.
void addEnds(const nlohmann::json& result, CampaignTally& tally);

}  // namespace tautline::experiments
