#include "app/bench/case_batch.h"

#include <fmt/format.h>

#include "app/bench/batch.h"
#include "app/bench/case_report.h"

namespace tautline::bench {

CaseBatchResult flyCases(const CaseBatch& cases) {
  Batch batch;
  batch.workers = cases.workers;
  batch.folder = cases.folder;
  batch.what = "flown";
  for (std::size_t i = 0; i < cases.count; ++i) {
    const FlightCase flight = cases.flight(i);
    batch.keys.push_back(fmt::format("{} seed {}", flight.name, flight.bench.seed));
  }
  batch.run = [&](std::size_t i) {
    const FlightCase flight = cases.flight(i);
    const auto sink = cases.sink ? cases.sink(flight) : nullptr;
    return toJson(runCase(flight, sink.get()));
  };
  batch.failed = [](const JobOutcome& o) { return !caseFromJson(o.line).passed(); };
  const BatchResult ran = runBatch(batch);

  CaseBatchResult result;
  result.known = ran.known;
  result.wall_s = ran.wall_s;
  for (std::size_t i = 0; i < cases.count; ++i) {
    const JobOutcome& outcome = ran.outcomes[i];
    if (outcome.failure.empty()) {
      result.cases.push_back(caseFromJson(outcome.line));
      continue;
    }
    const FlightCase flight = cases.flight(i);
    CaseResult dead;
    dead.name = flight.name;
    dead.seed = flight.bench.seed;
    dead.failure = outcome.failure;
    result.cases.push_back(dead);
  }
  return result;
}

}  // namespace tautline::bench
