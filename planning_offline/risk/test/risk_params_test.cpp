#include "planning_offline/risk/risk_params.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "common/toml/config_file.h"
#include "planning_offline/risk/risk_element.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kConfig = TAUTLINE_SOURCE_DIR "/config/risk";

InputProblem problemOf(const std::string& text) {
  try {
    (void)parseConfig<RiskParams>(text, "params.toml");
  } catch (const InputError& e) {
    return e.problem();
  }
  ADD_FAILURE() << "no InputError: " << text;
  return {};
}

TEST(RiskParams, DefaultFileIsTheDefaults) {
  EXPECT_EQ(readTextFile(kConfig / "default.toml"), dumpConfig(RiskParams{}))
      << "config/risk/default.toml is dumpConfig(RiskParams{})";
}

TEST(RiskParams, EveryShippedFileIsRead) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW((void)loadConfig<RiskParams>(entry.path())) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 1);
}

TEST(RiskParams, DumpReadsBack) {
  RiskParams params;
  params.mode = RiskMode::kRate;
  params.turn.law = TurnLaw::kThreshold;
  params.access.character = AccessCharacter::kVisibility;
  params.battery.member = {0.3, 0.9, 0.4};
  params.terrain_stability.scale = 0.7;
  const std::string text = dumpConfig(params);
  EXPECT_EQ(dumpConfig(parseConfig<RiskParams>(text, "dump")), text);
}

TEST(RiskParams, ChaptersSixElementsAreOnByDefault) {
  const RiskParams params;
  for (const auto& entry : kRiskElementNames) {
    const bool on =
        entry.value == RiskElement::kDistance || entry.value == RiskElement::kVisibility ||
        entry.value == RiskElement::kActionLength || entry.value == RiskElement::kTurn ||
        entry.value == RiskElement::kTetherLength || entry.value == RiskElement::kContacts;
    EXPECT_EQ(isOn(params, entry.value), on) << entry.name;
  }
}

TEST(RiskParams, EachElementHasItsSwitch) {
  const char* all =
      "scale = {risk = 0.1}\ndynamic_threat = {dwell_s = 1}\nsingularity = {risk = 0.1}\n"
      "verticality = {scale = 0.1}\nlateral_inclination = {scale = 0.1}\n"
      "terrain_stability = {scale = 0.1}\nsurface = {scale = 0.1}\naccess = {per_m = 0.1}\n"
      "slippage = {per_mud = 0.1}\nbattery = {risk = 0.1}\n";
  const auto on = parseConfig<RiskParams>(all, "f");
  for (const auto& entry : kRiskElementNames) EXPECT_TRUE(isOn(on, entry.value)) << entry.name;
  const char* none =
      "distance = {risk = 0}\nvisibility = {risk = 0}\naction_length = {per_m = 0}\n"
      "turn = {risk = 0}\ntether_length = {per_m = 0}\ncontacts = {each = 0}\n";
  const auto off = parseConfig<RiskParams>(none, "f");
  for (const auto& entry : kRiskElementNames) EXPECT_FALSE(isOn(off, entry.value)) << entry.name;
}

TEST(RiskParams, MembershipsInTheWrongOrderAreRefused) {
  struct Case {
    const char* text;
    const char* key;
    int line;
  };
  for (const Case& c : {Case{"[distance]\nfull_m = 2\nnone_m = 1.0", "distance.none_m", 3},
                        Case{"[distance]\nfull_m = 1.2", "distance.none_m", 1},
                        Case{"[scale]\nfull = 3", "scale.none", 1},
                        Case{"[visibility]\nnone_m = 0.5", "visibility.none_m", 2},
                        Case{"[singularity]\nnone_deg = 90", "singularity.none_deg", 2},
                        Case{"[battery]\nnone = 1.0", "battery.none", 2}}) {
    const InputProblem problem = problemOf(c.text);
    EXPECT_EQ(problem.key, c.key) << c.text;
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_FALSE(problem.allowed.empty());
  }
}

TEST(RiskParams, QuantumIsForRisksOfStates) {
  const InputProblem problem = problemOf("mode = \"rate\"\nquantum = 0.01");
  EXPECT_EQ(problem.key, "quantum");
  EXPECT_EQ(problem.line, 2);
  EXPECT_NO_THROW((void)parseConfig<RiskParams>("quantum = 0.01", "f"));
  EXPECT_NO_THROW((void)parseConfig<RiskParams>("mode = \"rate\"", "f"));
}

TEST(RiskParams, RisksOutsideZeroToOneAreRefusedWithTheirLine) {
  for (const char* text :
       {"\n[distance]\nrisk = 1.01", "\n[visibility]\nrisk = -0.1", "\n[contacts]\neach = 2",
        "\n[surface]\nscale = nan", "\n[battery]\nrisk = inf", "\n[scale]\nrisk = \"high\""}) {
    const InputProblem problem = problemOf(text);
    EXPECT_EQ(problem.line, 3) << text;
    EXPECT_THAT(problem.allowed, HasSubstr("0 to 1")) << text;
  }
  EXPECT_THAT(problemOf("[turn]\nlaw = \"cubic\"").allowed, HasSubstr("threshold"));
  EXPECT_EQ(problemOf("[distanse]\nrisk = 0.1").remedy, "did you mean 'distance'?");
}

}  // namespace
}  // namespace tautline::planning
