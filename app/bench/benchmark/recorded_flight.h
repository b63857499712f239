#pragma once

/// @file
/// What the core saw in every cycle of a whole simulated flight, kept in memory, so that a
/// benchmark can step it again. Benchmarks only.

#include <deque>
#include <filesystem>
#include <vector>

#include "app/bench/lockstep.h"
#include "app/station/station.h"
#include "common/mission/mission_file.h"

namespace tautline::bench {

struct RecordedFlight {
  LockstepConfig config;  ///< Of the flight; the station's home is the scene's start.
  Mission mission;
  std::vector<StepInput> cycles;
  std::deque<tautline::mission_chunk_t> chunks;  ///< What StepInput::chunk points to.
};

/// Flies `mission` of `config_folder` in its scene with seed 1. @throws InputError if a file is
/// wrong or the mission is not completed.
[[nodiscard]] RecordedFlight recordFlight(const std::filesystem::path& config_folder,
                                          const std::string& mission, const std::string& scene);

}  // namespace tautline::bench
