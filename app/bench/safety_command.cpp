#include "app/bench/safety_command.h"

#include <fnmatch.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/bench/campaign.h"
#include "app/bench/case_report.h"
#include "app/bench/worker_pool.h"
#include "common/clock.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

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

struct Shard {
  std::size_t index{1};
  std::size_t count{1};
};

Shard parseShard(const std::string& text) {
  Shard s;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, s.index);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, s.count) : first;
  const bool good =
      slash && second.ec == std::errc{} && second.ptr == end && s.index >= 1 && s.index <= s.count;
  if (good) return s;
  throw InputError({.key = "--shard",
                    .problem = "\"" + text + "\" is none",
                    .allowed = "I/N with 1 <= I <= N, e.g. 2/4"},
                   ExitCode::kUsage);
}

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

/// Results that an earlier run has left in a folder, and where this one adds its own.
class ResultFile {
 public:
  explicit ResultFile(const std::string& folder) {
    if (folder.empty()) return;
    fs::create_directories(folder);
    const fs::path path = fs::path(folder) / "results.jsonl";
    std::string line;
    for (std::ifstream in(path); std::getline(in, line);) {
      // A run that was killed leaves half a line.
      if (line.empty() || line.back() != '}') continue;
      CaseResult r = caseFromJson(line);
      known_[{r.name, r.seed}] = std::move(r);
    }
    out_.open(path, std::ios::app);
    if (!out_) {
      throw InputError({.file = path.string(),
                        .problem = "cannot be written",
                        .remedy = "choose another folder for --resume"});
    }
  }

  [[nodiscard]] const CaseResult* find(const std::string& name, std::uint64_t seed) const {
    const auto found = known_.find({name, seed});
    return found == known_.end() ? nullptr : &found->second;
  }
  void add(const CaseResult& result) {
    if (out_.is_open()) out_ << toJson(result) << std::endl;
  }

 private:
  std::map<std::pair<std::string, std::uint64_t>, CaseResult> known_;
  std::ofstream out_;
};

/// A line that stays one line, on a terminal; nothing elsewhere.
class Progress {
 public:
  explicit Progress(std::size_t total) : total_(total), visible_(::isatty(STDERR_FILENO) == 1) {}
  void add(const CaseResult& result) {
    ++done_;
    failed_ += result.passed() ? 0U : 1U;
    if (!visible_) return;
    fmt::print(stderr, "\r{} of {} flown, {} failed ", done_, total_, failed_);
    std::fflush(stderr);
  }
  void end() const {
    if (visible_) fmt::print(stderr, "\r{:50}\r", "");
  }

 private:
  std::size_t total_;
  std::size_t done_{0};
  std::size_t failed_{0};
  bool visible_;
};

ExitCode flyCampaign(const Options& o) {
  Campaign campaign = readCampaign(o.table);
  campaign.seed += o.seed;
  const std::vector<CampaignCase> cases = select(campaign, o);
  if (o.list) {
    for (const CampaignCase& c : cases) fmt::print("{}\n", c.name);
    return ExitCode::kOk;
  }
  ResultFile file(o.resume);
  std::vector<CaseResult> results;
  std::vector<const CampaignCase*> left;
  for (const CampaignCase& c : cases) {
    const CaseResult* known = file.find(c.name, flightOf(campaign, c).bench.seed);
    if (known != nullptr) {
      results.push_back(*known);
    } else {
      left.push_back(&c);
    }
  }
  if (!results.empty()) fmt::print("{} cases were flown before\n", results.size());

  Progress progress(left.size());
  PoolJob job;
  job.count = left.size();
  job.workers = o.jobs;
  job.name = [&](std::size_t i) { return left[i]->name; };
  job.fly = [&](std::size_t i) { return runCase(flightOf(campaign, *left[i]), nullptr); };
  job.each_result = [&](const CaseResult& result) {
    file.add(result);
    progress.add(result);
  };
  const Time began = monotonicNow();
  const std::vector<CaseResult> flown = flyAll(job);
  const double wall_s = toSeconds(monotonicNow() - began);
  progress.end();
  results.insert(results.end(), flown.begin(), flown.end());

  const std::string seed = o.seed != 0 ? fmt::format(" --seed {}", o.seed) : "";
  for (const CaseResult& r : results) {
    if (!r.passed())
      fmt::print("{}\n",
                 failureLine(r, fmt::format("tautline-bench safety --table {} --case '{}'{}",
                                            o.table, r.name, seed)));
  }
  if (!o.junit.empty()) writeJunit(o.junit, "safety", results);
  if (!o.json.empty()) writeJson(o.json, results);
  fmt::print("{}\n", summary(results, wall_s));
  return noneFailed(results) ? ExitCode::kOk : ExitCode::kFailed;
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
