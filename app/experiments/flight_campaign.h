#pragma once

/// @file
/// Monte Carlo flights of a planned mission: what was predicted of it, and what came of it.
/// docs/risk_campaign.md. Not real-time safe.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/bench/batch.h"
#include "app/experiments/binomial.h"
#include "app/experiments/mission_flight.h"
#include "app/station/station_config.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "sim_hil/sim_config.h"

namespace tautline::experiments {

/// A mission in a world, and who flies it on which plant.
struct CampaignFlight {
  StationConfig station;
  sim::SimConfig plant;
  Scene world;  ///< In W.
  const Mission* mission{nullptr};
  double goal_tolerance{kGoalTolerance};  ///< [m]

  /// The station knows the obstacles if there are not more than its fence holds.
  [[nodiscard]] bool mapKnown() const noexcept { return world.boxes.size() <= kMaxFenceObstacles; }
  [[nodiscard]] bench::LockstepConfig config(std::uint64_t seed) const {
    return {
        .station = station, .sim = plant, .world = world, .map_known = mapKnown(), .seed = seed};
  }
  /// Changes whenever any of this does, or the program.
  [[nodiscard]] std::string fingerprint() const;
};

struct CampaignOptions {
  std::int64_t flights{0};
  std::uint64_t seed{1};  ///< Of the first flight; the others' follow.
  bench::Shard shard;
  int workers{0};
  std::string folder;  ///< Keeps what was flown (bench::Batch); empty: nowhere.
};

struct CampaignTally {
  std::array<std::int64_t, kFlightEndNames.size()> ends{};  ///< By FlightEnd.
  std::vector<FlightVerdict> verdicts;                      ///< In the order of the seeds.
  std::size_t known{0};                                     ///< Of them found in the folder.

  [[nodiscard]] std::int64_t flights() const noexcept {
    return static_cast<std::int64_t>(verdicts.size());
  }
  [[nodiscard]] std::int64_t failed() const noexcept {
    return flights() - ends[static_cast<std::size_t>(FlightEnd::kFinished)];
  }
  /// Of the flights; NaN without any.
  [[nodiscard]] double finishedShare() const noexcept {
    return 1.0 - static_cast<double>(failed()) / static_cast<double>(flights());
  }
  [[nodiscard]] Interval interval() const { return clopperPearson(failed(), flights()); }
  void add(const FlightVerdict& verdict);
};

/// Throws InputError (kFailed) for the first flight that could not be flown, and what the world or
/// the configurations are refused for.
[[nodiscard]] CampaignTally flyFlights(const CampaignFlight& flight,
                                       const CampaignOptions& options);

}  // namespace tautline::experiments
