#include "app/bench/safety_command.h"

#include <fnmatch.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/bench/batch.h"
#include "app/bench/campaign.h"
#include "app/bench/case_batch.h"
#include "app/bench/case_report.h"

namespace tautline::bench {
namespace {

constexpr std::size_t kQuick = 150;  // cases

struct Options {
  std::string table{"config/scenarios/campaign.toml"};
  std::string glob{"*"};
  std::string shard{"1/1"};
  std::size_t sample{0};
  std::uint64_t seed{0};
  int jobs{0};
  std::string junit;
  std::string json;
  std::string resume;
  bool quick{false};
  bool list{false};
};

/// What of the campaign is to be flown: by name, then a sample spread over it, then a shard of
/// that.
std::vector<CampaignCase> select(const Campaign& campaign, const Options& o) {
  std::vector<CampaignCase> named;
  for (CampaignCase& c : campaignCases(campaign)) {
    if (::fnmatch(o.glob.c_str(), c.name.c_str(), 0) == 0 || o.glob == c.name)
      named.push_back(std::move(c));
  }
  const std::size_t wanted = o.sample > 0 ? o.sample : o.quick ? kQuick : named.size();
  const std::size_t count = std::min(wanted, named.size());
  const Shard shard = parseShard(o.shard);
  std::vector<CampaignCase> cases;
  for (std::size_t i = shard.index - 1; i < count; i += shard.count)
    cases.push_back(named[i * named.size() / count]);
  if (cases.empty()) {
    throw InputError(
        {.file = o.table,
         .problem = "no case is chosen by --case \"" + o.glob + "\", --shard " + o.shard,
         .remedy = "see `tautline-bench safety --list`"},
        ExitCode::kFailed);
  }
  return cases;
}

ExitCode flyCampaign(const Options& o) {
  Campaign campaign = readCampaign(o.table);
  campaign.seed += o.seed;
  const std::vector<CampaignCase> cases = select(campaign, o);
  if (o.list) {
    for (const CampaignCase& c : cases) fmt::print("{}\n", c.name);
    return ExitCode::kOk;
  }
  CaseBatch batch;
  batch.count = cases.size();
  batch.workers = o.jobs;
  batch.folder = o.resume;
  batch.flight = [&](std::size_t i) { return flightOf(campaign, cases[i]); };
  const CaseBatchResult result = flyCases(batch);
  if (result.known > 0) fmt::print("{} cases were flown before\n", result.known);

  const std::string seed = o.seed != 0 ? fmt::format(" --seed {}", o.seed) : "";
  for (const CaseResult& r : result.cases) {
    if (!r.passed())
      fmt::print("{}\n",
                 failureLine(r, fmt::format("tautline-bench safety --table {} --case '{}'{}",
                                            o.table, r.name, seed)));
  }
  if (!o.junit.empty()) writeJunit(o.junit, "safety", result.cases);
  if (!o.json.empty()) writeJson(o.json, result.cases);
  fmt::print("{}\n", summary(result.cases, result.wall_s));
  return allPassed(result.cases) ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addSafetyCommand(CLI::App& app, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "safety", "Fly the safety campaign: every fault in every phase, and pairs of them");
  verb->add_option("--table", options->table, "the campaign's table")->capture_default_str();
  verb->add_flag("--quick", options->quick, fmt::format("a sample of {} cases", kQuick));
  verb->add_option("--sample", options->sample, "this many cases, spread over the campaign");
  verb->add_option("--case", options->glob, "only those whose name fits, e.g. '*/AUTO/encoder*'")
      ->capture_default_str();
  verb->add_option("--shard", options->shard, "I/N: the I-th of N equal parts")
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "added to the table's seed")->capture_default_str();
  verb->add_option("--jobs", options->jobs, "processes; 0: one for each processor")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  verb->add_option("--junit", options->junit, "write JUnit's XML");
  verb->add_option("--json", options->json, "write all results as JSON");
  verb->add_option("--resume", options->resume,
                   "keep results in this folder and do not fly again what is there");
  verb->add_flag("--list", options->list, "print the cases' names, then stop");
  verb->footer("Example: tautline-bench safety --shard 1/4 --resume build/safety --junit out.xml");
  verb->callback([options, &result] { result = flyCampaign(*options); });
}

}  // namespace tautline::bench
