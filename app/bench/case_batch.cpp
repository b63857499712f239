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
    return toJson(cases.fly ? cases.fly(flight, sink.get()) : runCase(flight, sink.get()));
  };
  const auto result_of = [&](std::size_t i, const JobOutcome& outcome) {
    if (outcome.failure.empty()) return caseFromJson(outcome.line);
    CaseResult dead = resultOf(cases.flight(i));
    dead.failure = outcome.failure;
    return dead;
  };
  batch.failed = [](const JobOutcome& o) { return !caseFromJson(o.line).passed(); };
  if (cases.each)
    batch.each = [&](std::size_t i, const JobOutcome& o) { cases.each(i, result_of(i, o)); };
  const BatchResult ran = runBatch(batch);

  CaseBatchResult result;
  result.known = ran.known;
  result.wall_s = ran.wall_s;
  for (std::size_t i = 0; i < cases.count; ++i)
    result.cases.push_back(result_of(i, ran.outcomes[i]));
  return result;
}

}  // namespace tautline::bench
