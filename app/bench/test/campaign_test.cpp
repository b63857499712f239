// Scenario files and the safety campaign: what they read, what they notice, and that nothing is
// passed by for good.

#include "app/bench/campaign.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/bench/batch.h"
#include "app/bench/case_report.h"
#include "app/bench/case_runner.h"
#include "app/bench/hil_rig.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

const fs::path kScenarios = fs::path(TAUTLINE_SOURCE_DIR) / "config" / "scenarios";

/// A scenario with this text after its head, in a file of its own beside the shipped ones' folder.
FlightCase scenario(const std::string& text) {
  const fs::path path = fs::path(::testing::TempDir()) / "tautline_case.scenario.toml";
  std::ofstream(path) << "version = 1\nname = \"test\"\nscene = \""
                      << (kScenarios / "../scenes/open.scene.toml").string() << "\"\nmission = \""
                      << (kScenarios / "campaign.mission.toml").string()
                      << "\"\nstation_config = \"" << (kScenarios / "../station.toml").string()
                      << "\"\n"
                      << text;
  FlightCase flight = readScenario(path.string());
  fs::remove(path);
  return flight;
}

std::string failureOf(const std::string& text) { return runCase(scenario(text), nullptr).failure; }

std::string problemOf(const std::string& text) {
  try {
    static_cast<void>(scenario(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Scenario, WithoutFaultsTheMissionIsFlownAndLanded) {
  const CaseResult r = runCase(scenario("[limits]\nend_mode = \"STANDBY\"\nlanded = true\n"
                                        "[[expect]]\nphase = \"AUTO\"\nwithin_s = 60.0\n"
                                        "event = \"mission completed\"\n"),
                               nullptr);
  EXPECT_EQ(r.failure, "");
  EXPECT_GT(r.height_max_m, 1.0);
  EXPECT_FALSE(r.faulted);
}

TEST(Scenario, WhatIsNotMetIsSaid) {
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(
      contains(failureOf("[limits]\nmax_height_m = 0.5\n"), "above the floor (limit 0.50 m)"));
  EXPECT_TRUE(contains(failureOf("[limits]\nend_mode = \"ESTOP\"\n"), "expected to end in ESTOP"));
  EXPECT_TRUE(
      contains(failureOf("[[expect]]\nphase = \"HOLD\"\nwithin_s = 1.0\nmode = \"ESTOP\"\n"),
               "expected ESTOP within 1 s: in HOLD"));
  EXPECT_TRUE(
      contains(failureOf("[[expect]]\nphase = \"TAKEOFF\"\nwithin_s = 9.0\nbound = \"height_m\"\n"
                         "max = 0.4\n"),
               "expected height_m from"));
  EXPECT_TRUE(
      contains(failureOf("[[fault]]\ntarget = \"motors\"\nmode = \"off\"\nphase = \"HOLD\"\n"),
               "crash: hard landing"));
  EXPECT_TRUE(
      contains(failureOf("[[fault]]\ntarget = \"encoder\"\nmode = \"off\"\nphase = \"ESTOP\"\n"),
               "never got as far as its fault"));
  EXPECT_TRUE(contains(failureOf("[[sequence]]\nfrom = \"STANDBY\"\nto = \"ESTOP\"\n"),
                       "ARMED followed STANDBY"));
}

TEST(Scenario, NamesThatAreNoneAreListedWithLineAndKey) {
  const auto says = [](const std::string& text, std::initializer_list<const char*> parts) {
    const std::string problem = problemOf(text);
    for (const char* part : parts)
      EXPECT_NE(problem.find(part), std::string::npos) << part << " is not in: " << problem;
  };
  says("[[fault]]\ntarget = \"encoder\"\nmode = \"off\"\nphase = \"FLY\"\n",
       {"tautline_case.scenario.toml:", "FLY", "STANDBY", "ENCODER_STALE"});
  says("[limits]\nend_mode = \"STANDBY AIR\"\n", {"AIR", "TAKEOFF"});
  says("[[expect]]\ncondition = \"COLD\"\n", {"COLD", "ANGLES_STALE"});
  says("[[expect]]\nevent = \"tea is ready\"\n", {"tea is ready", "mission completed"});
  says("[[expect]]\nbound = \"mood\"\n", {"mood", "height_m"});
  says("[[expect]]\nwithin_s = 1.0\n", {"one of mode, condition, clear, event, bound"});
  says("[[operator]]\nverb = \"sing\"\n", {"sing", "navigate"});
  says("[[fault]]\ntarget = \"camera\"\nmode = \"off\"\n", {"not supported", "video"});
  says("colour = \"red\"\n", {"colour"});
}

TEST(Scenario, TheSameSeedGivesTheSameFlight) {
  const char* text =
      "seed = 7\n[[fault]]\ntarget = \"link.vehicle\"\nmode = \"garbage\"\nphase = \"AUTO\"\nfor_s "
      "= 4.0\n"
      "value = 0.1\n";
  const CaseResult a = runCase(scenario(text), nullptr);
  const CaseResult b = runCase(scenario(text), nullptr);
  FlightCase other = scenario(text);
  other.bench.seed = 8;
  const CaseResult c = runCase(other, nullptr);
  EXPECT_EQ(a.height_max_m, b.height_max_m);
  EXPECT_EQ(a.flight_s, b.flight_s);
  EXPECT_NE(a.height_max_m, c.height_max_m);
}

TEST(Bench, FaultsRoundTheMachine) {
  // The loop stalls: seen as missed ticks. The clock jumps: nobody may take old samples for new.
  for (const char* mode : {"delayed", "wrong"}) {
    const std::string text =
        std::string("[[fault]]\ntarget = \"loop\"\nmode = \"") + mode +
        "\"\nphase = \"AUTO\"\nat_s = 2.0\nfor_s = 2.0\nvalue = 0.4\n" +
        (std::string(mode) == "delayed"
             ? "[[expect]]\nphase = \"FAULT\"\nwithin_s = 1.5\ncondition = \"OVERRUNS\"\n"
             : "");
    EXPECT_EQ(failureOf(text), "") << mode;
  }
  // Nobody hears the operator ask for the mission: the drone hovers and is landed when he is heard.
  EXPECT_EQ(failureOf("[[fault]]\ntarget = \"link.operator\"\nmode = \"off\"\nphase = \"HOLD\"\n"
                      "for_s = 5.0\n[[expect]]\nphase = \"HOLD\"\nafter_s = 4.0\nwithin_s = 0.1\n"
                      "mode = \"HOLD\"\n[limits]\nend_mode = \"STANDBY\"\nlanded = true\n"),
            "");
  EXPECT_EQ(
      failureOf("[[fault]]\ntarget = \"bus\"\nmode = \"unplug\"\nphase = \"HOLD\"\nfor_s = 2.0\n"
                "[[expect]]\nphase = \"FAULT\"\nwithin_s = 0.2\ncondition = \"LINK_VEHICLE\"\n"),
      "");
}

class CampaignTable : public ::testing::Test {
 protected:
  static const Campaign& campaign() {
    static const Campaign table = readCampaign((kScenarios / "campaign.toml").string());
    return table;
  }
};

TEST_F(CampaignTable, HasThreeThousandCasesWithNamesOfTheirOwn) {
  const auto cases = campaignCases(campaign());
  EXPECT_GE(cases.size(), 3000U);
  std::set<std::string> names;
  for (const CampaignCase& c : cases) names.insert(c.name);
  EXPECT_EQ(names.size(), cases.size());
}

TEST_F(CampaignTable, HasEveryKindOfTheMenuThatTheBenchCanFly) {
  for (const sim::FaultKind& kind : sim::faultMenu()) {
    // Contacts need a scene with one: config/scenarios/contact_*.scenario.toml.
    const bool contact =
        kind.mode == sim::FaultMode::kContactSlip || kind.mode == sim::FaultMode::kContactOff;
    if (kind.place == sim::FaultPlace::kNowhere || contact) continue;
    EXPECT_TRUE(std::any_of(campaign().rows.begin(), campaign().rows.end(),
                            [&](const CampaignRow& row) {
                              return row.fault.target == kind.target && row.fault.mode == kind.mode;
                            }))
        << kind.effect;
  }
}

TEST_F(CampaignTable, EveryConditionOfTheFailsafeTableHasAScenarioInLockstepAndInHil) {
  // Checks before the flight, and what no lock-step flight has: a host, LCM, a recorder.
  const ConditionSet elsewhere{Condition::kVehicleFlying,
                               Condition::kNoOperator,
                               Condition::kLinkFault,
                               Condition::kLoopJitter,
                               Condition::kRealTimeMissing,
                               Condition::kLogOff,
                               Condition::kDiskLow,
                               Condition::kConfigBad,
                               Condition::kLengthUncalibrated,
                               Condition::kAzimuthUncalibrated,
                               Condition::kSimMismatch,
                               Condition::kFaultLatched,
                               Condition::kTeleopStale};
  ConditionSet expected;
  for (const fs::directory_entry& entry : fs::directory_iterator(kScenarios)) {
    if (!entry.path().string().ends_with(".scenario.toml")) continue;
    const FlightCase flight = readScenario(entry.path().string());
    if (!whyOnlyInLockstep(flight).empty()) continue;
    for (const Expectation& e : flight.expectations) {
      if (e.kind == Expectation::Kind::kCondition) expected = expected | e.conditions;
    }
  }
  const ConditionSet owed =
      conditionsOf(ConditionKind::kForbidsArming) | conditionsOf(ConditionKind::kInFlight);
  EXPECT_EQ(describe(owed.without(expected | elsewhere)), "");
}

TEST_F(CampaignTable, EveryFlagAndFlightModeIsARow) {
  std::set<std::string> labels;
  for (const CampaignRow& row : campaign().rows) labels.insert(describe(row.fault));
  for (const sim::VehicleCode& c : sim::vehicleFlags())
    EXPECT_TRUE(labels.contains(std::string("flag:") + c.name + " on")) << c.name;
  for (const sim::VehicleCode& c : sim::vehicleFlightModes())
    EXPECT_TRUE(labels.contains(std::string("mode:") + c.name + " on")) << c.name;
}

TEST_F(CampaignTable, SeedsComeFromTheName) {
  const auto cases = campaignCases(campaign());
  EXPECT_NE(flightOf(campaign(), cases[0]).bench.seed, flightOf(campaign(), cases[1]).bench.seed);
  EXPECT_EQ(flightOf(campaign(), cases[0]).bench.seed, flightOf(campaign(), cases[0]).bench.seed);
}

TEST(WorkerPool, ADeadWorkerIsAFailedJobAndTheOthersGoOn) {
  PoolJob job;
  job.count = 7;
  job.workers = 2;
  job.run = [](std::size_t i) {
    if (i == 2) std::raise(SIGABRT);
    if (i == 5) throw InputError({.problem = "bad"});
    return "job " + std::to_string(i);
  };
  std::map<std::size_t, JobOutcome> heard;
  job.each = [&](std::size_t i, const JobOutcome& outcome) { heard[i] = outcome; };
  runAll(job);
  ASSERT_EQ(heard.size(), 7U);
  for (const auto& [i, outcome] : heard) {
    const bool bad = i == 2 || i == 5;
    EXPECT_EQ(outcome.line, bad ? "" : "job " + std::to_string(i));
    EXPECT_EQ(outcome.failure.empty(), !bad);
  }
  EXPECT_NE(heard[2].failure.find("signal 6"), std::string::npos);
  EXPECT_NE(heard[5].failure.find("bad"), std::string::npos);
}

TEST(Batch, GoesOnWhereItWasInterrupted) {
  const fs::path folder = fs::path(::testing::TempDir()) / "tautline_batch";
  fs::remove_all(folder);
  Batch batch;
  batch.keys = {"a", "b", "c"};
  batch.workers = 1;
  batch.folder = folder.string();
  batch.run = [](std::size_t i) -> std::string {
    if (i == 1) throw InputError({.problem = "not yet"});
    return "first " + std::to_string(i);
  };
  const BatchResult first = runBatch(batch);
  EXPECT_EQ(first.known, 0U);
  EXPECT_FALSE(first.outcomes[1].failure.empty());
  std::ofstream(folder / "results.txt", std::ios::app) << "b\thalf a li";  // killed here

  batch.run = [](std::size_t i) { return "second " + std::to_string(i); };
  const BatchResult second = runBatch(batch);
  EXPECT_EQ(second.known, 2U);
  EXPECT_EQ(second.outcomes[0].line, "first 0");
  EXPECT_EQ(second.outcomes[1].line, "second 1");
  EXPECT_EQ(second.outcomes[2].line, "first 2");
  EXPECT_EQ(runBatch(batch).known, 3U);

  // Half a line that nobody has flown again stays half a line.
  batch.keys.push_back("d");
  std::ofstream(folder / "results.txt", std::ios::app) << "d\thalf";
  batch.run = [](std::size_t) -> std::string { throw InputError({.problem = "not now"}); };
  EXPECT_EQ(runBatch(batch).known, 3U);
  EXPECT_EQ(runBatch(batch).known, 3U);
  fs::remove_all(folder);
}

TEST(Shard, PartsShareTheWhole) {
  const Shard a = parseShard("1/3");
  const Shard c = parseShard("3/3");
  EXPECT_TRUE(a.has(0) && a.has(3) && c.has(2));
  EXPECT_FALSE(a.has(1) || c.has(0));
  for (const char* bad : {"", "1", "0/2", "3/2", "1/2x", "a/b"})
    EXPECT_THROW(static_cast<void>(parseShard(bad)), InputError) << bad;
}

TEST(CaseReport, JsonComesBackAndJunitIsWritten) {
  CaseResult r;
  r.name = "a <b> & \"c\"";
  r.seed = 0xFFFFFFFFFFFFFFFFULL;
  r.failure = "crash";
  r.end = Mode::kLand;
  r.flight_s = 12.5;
  const CaseResult back = caseFromJson(toJson(r));
  EXPECT_EQ(back.name, r.name);
  EXPECT_EQ(back.seed, r.seed);
  EXPECT_EQ(back.failure, r.failure);
  EXPECT_EQ(back.end, r.end);
  EXPECT_THROW(static_cast<void>(caseFromJson("half a li")), InputError);

  const fs::path path = fs::path(::testing::TempDir()) / "tautline_junit.xml";
  CaseResult skipped;
  skipped.skipped = "not here";
  EXPECT_EQ(caseFromJson(toJson(skipped)).skipped, "not here");
  writeJunit(path.string(), "suite", {r, CaseResult{}, skipped});
  std::ifstream in(path);
  const std::string xml{std::istreambuf_iterator<char>(in), {}};
  fs::remove(path);
  EXPECT_NE(xml.find("tests=\"3\" failures=\"1\" skipped=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("a &lt;b&gt; &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_FALSE(allPassed({r}));
  EXPECT_TRUE(allPassed({CaseResult{}}));
  EXPECT_TRUE(allPassed({CaseResult{}, skipped}));
  EXPECT_FALSE(allPassed({skipped})) << "nothing was flown";
  EXPECT_NE(summary({CaseResult{}, skipped}, 1.0).find("\n1 passed, 0 failed, 1 only in lock-step"),
            std::string::npos);
  EXPECT_TRUE(summary({CaseResult{}}, 1.0).ends_with("\n1 passed, 0 failed"));
}

}  // namespace
}  // namespace tautline::bench
