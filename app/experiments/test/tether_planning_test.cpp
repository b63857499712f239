// The tether planning experiment: its paths, and a flight of ours.

#include "app/experiments/tether_planning.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace tautline::experiments {
namespace {

TEST(TetherPlanning, OursFliesRoundTheShaftWithOneContact) {
  const experiments::Setup setup =
      loadSetup(std::filesystem::path(TAUTLINE_SOURCE_DIR) / "config/experiments", true, 1);
  int flown = 0;
  for (const Trial& trial : kTetherPlanning.trials(setup)) {
    if (trial.name != "Tautline, one contact, relaxed, 1") continue;
    ++flown;
    const nlohmann::json result = trial.run();
    EXPECT_TRUE(result.at("completed").get<bool>()) << result.at("ended");
    EXPECT_EQ(result.at("crash"), "none");
    EXPECT_FALSE(result.at("by_contacts").at(0).is_null());
    EXPECT_FALSE(result.at("by_contacts").at(1).is_null());
    EXPECT_TRUE(result.at("by_contacts").at(2).is_null());
    EXPECT_GT(result.at("error").get<double>(), 0.0);
    EXPECT_LT(result.at("error").get<double>(), 0.5);
    EXPECT_EQ(result, trial.run());  // a trial is its seed's
  }
  EXPECT_EQ(flown, 1);
}

}  // namespace
}  // namespace tautline::experiments
