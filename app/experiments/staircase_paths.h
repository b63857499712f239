#pragma once

/// @file
/// The two viewpoints of the staircase (dissertation chapter 7), the paths to them and who flies
/// them. Not real-time safe.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/experiments/experiment.h"
#include "app/experiments/flight_campaign.h"
#include "app/experiments/planned_path.h"
#include "app/experiments/setup.h"
#include "common/plot/figure.h"
#include "planning_offline/cli/workspace.h"

namespace tautline::experiments {

struct Viewpoint {
  const char* name;
  Eigen::Vector3d goal;  ///< M [m].
  double reward;
  double risk;     ///< Published, chapter 7, as the next two.
  double utility;  ///< Reward over risk.
  int successes;   ///< Of kPublishedTrials.
  double wanted;   ///< Share of our flights that finishes, at least.
  plot::Colour colour;
};
inline const std::array kViewpoints{
    Viewpoint{"red", {5.0, 0.6, 4.2}, 1.0, 0.714, 1.401, 2, 0.85, plot::Colour::kVermilion},
    Viewpoint{"green", {3.8, 2.6, 1.4}, 0.9, 0.575, 1.565, 4, 0.95, plot::Colour::kGreen}};
inline constexpr int kPublishedTrials = 10;

/// Of each station and viewpoint.
using StairTallies =
    std::array<std::array<CampaignTally, kViewpoints.size()>, kStationNames.size()>;

/// Map, planned paths, and who flies them.
struct Stairs {
  Stairs() = default;
  Stairs(const Stairs&) = delete;  // `flights` point into `paths`
  Stairs& operator=(const Stairs&) = delete;

  planning::RiskSpace space;
  std::array<PlannedPath, kViewpoints.size()> paths;
  std::array<std::array<CampaignFlight, kViewpoints.size()>, kStationNames.size()>
      flights;  ///< [station][viewpoint]
};
/// Throws InputError for files of the set-up; that there is a path to each viewpoint is taken for
/// granted.
[[nodiscard]] std::shared_ptr<const Stairs> planStairs(const Setup& setup);

/// Calls visit(station, viewpoint) for all of them.
template <class Visit>
void forEachStairs(Visit visit) {
  for (std::size_t station = 0; station < kStationNames.size(); ++station)
    for (std::size_t v = 0; v < kViewpoints.size(); ++v) visit(station, v);
}

/// Some flights: how each ended and, on request, its way.
struct StairTrial {
  std::uint64_t seed{1};  ///< Of the first.
  std::int64_t flights{1};
  bool tracks{false};
  std::optional<double> pull{};  ///< On the tether, other than the plant's [N].
};
/// {"ends": verdicts of toJson(), "tracks": true ways in W [m], two points a second}.
[[nodiscard]] nlohmann::json flyStairs(const CampaignFlight& flight, const StairTrial& trial);
/// Adds what flyStairs() returned.
void addEnds(const nlohmann::json& result, CampaignTally& tally);

/// So many flights of each station to each viewpoint, a few a trial; the first few with their ways.
[[nodiscard]] std::vector<Trial> stairTrials(const Setup& setup,
                                             const std::shared_ptr<const Stairs>& stairs,
                                             std::int64_t flights);
/// Of the trial that begins with this flight.
[[nodiscard]] std::string stairTrialName(std::size_t station, std::size_t viewpoint,
                                         std::int64_t first);
/// How the flights of stairTrials() ended.
[[nodiscard]] StairTallies stairTallies(const Results& results, std::int64_t flights);

/// Share of flights that finish, against the exact 95 % interval of the published trials; `ours` is
/// told, not judged.
[[nodiscard]] Row successRow(const Viewpoint& view, const CampaignTally& as_published,
                             const CampaignTally& ours);

}  // namespace tautline::experiments
