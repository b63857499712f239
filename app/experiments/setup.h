#pragma once

/// @file
/// What all experiments share: a plant, the two stations that are compared on it, and the
/// published figures (config/experiments). Not real-time safe: start-up only.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "app/bench/lockstep.h"
#include "app/station/station_config.h"
#include "common/mission/scene.h"
#include "sim_hil/sim_config.h"

namespace tautline::experiments {

struct Setup {
  std::filesystem::path folder;  ///< Of config/experiments.
  bool quick{false};             ///< Fewer trials: a sample that CI can afford.
  std::uint64_t seed{1};         ///< Of the first trial; the same for both stations.
  sim::SimConfig plant;          ///< plant.toml: the machine of all but rough_air.
  StationConfig as_published;    ///< as_published.toml: the dissertation's software.
  StationConfig tautline;        ///< tautline.toml: ours.

  /// Changes whenever any of this does, or the program.
  [[nodiscard]] std::string fingerprint() const;

  /// A flight with one of the stations. `world` is in W, with a start.
  [[nodiscard]] bench::LockstepConfig flight(const StationConfig& station, const Scene& world,
                                             std::uint64_t trial) const {
    return {
        .station = station, .sim = plant, .world = world, .map_known = true, .seed = seed + trial};
  }
};

/// The two stations of a comparison, by index.
inline constexpr std::array kStationNames{"as published", "ours"};

/// For planned paths: the published software as it flew its integrated demonstration, with all of
/// its low-level motion suite, so with the corrected localizer, and position control; or ours.
[[nodiscard]] StationConfig demonstrationStation(const Setup& setup, std::size_t station);

/// Tells a station what pull the vehicle keeps on the tether [N].
void tellPull(StationConfig& station, double tension);

/// Lets vehicle and station of a flight use another pull on the tether [N] than the set-up's, as a
/// user would who has set the vehicle so.
void pullWith(bench::LockstepConfig& flight, double tension);

/// Throws InputError.
[[nodiscard]] Setup loadSetup(const std::filesystem::path& folder, bool quick, std::uint64_t seed);

}  // namespace tautline::experiments
