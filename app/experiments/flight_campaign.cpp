#include "app/experiments/flight_campaign.h"

#include <fmt/format.h>

#include "app/experiments/map_world.h"
#include "common/error.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {

std::string CampaignFlight::fingerprint() const {
  return hashText(fnv1a(readTextFile("/proc/self/exe") + dumpConfig(station) + dumpConfig(plant) +
                        sceneText(world) + canonicalText(*mission) +
                        fmt::format("{}", goal_tolerance)));
}

void CampaignTally::add(const FlightVerdict& verdict) {
  ++ends[static_cast<std::size_t>(verdict.end)];
  verdicts.push_back(verdict);
}

CampaignTally flyFlights(const CampaignFlight& flight, const CampaignOptions& options) {
  // What is refused is refused here, and not by each of the workers.
  const bench::Lockstep tried(flight.config(options.seed), nullptr);
  std::vector<std::uint64_t> seeds;
  for (std::int64_t i = 0; i < options.flights; ++i) {
    if (options.shard.has(static_cast<std::size_t>(i)))
      seeds.push_back(options.seed + static_cast<std::uint64_t>(i));
  }
  bench::Batch batch;
  const std::string fingerprint = flight.fingerprint();
  for (const std::uint64_t seed : seeds)
    batch.keys.push_back(fmt::format("{} {}", fingerprint, seed));
  batch.workers = options.workers;
  batch.folder = options.folder;
  batch.what = "flights";
  batch.run = [&](std::size_t i) {
    return toJson(flyPlanned(flight.config(seeds[i]), *flight.mission->plan, flight.goal_tolerance))
        .dump();
  };
  const bench::BatchResult result = bench::runBatch(batch);
  CampaignTally tally;
  tally.known = result.known;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const bench::JobOutcome& outcome = result.outcomes[i];
    if (!outcome.failure.empty()) {
      throw InputError({.key = fmt::format("flight with seed {}", seeds[i]),
                        .problem = "could not be flown: " + outcome.failure},
                       ExitCode::kFailed);
    }
    tally.add(verdictFrom(nlohmann::json::parse(outcome.line)));
  }
  return tally;
}

}  // namespace tautline::experiments
