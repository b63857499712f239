#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "planning_offline/risk/risk_report.h"
#include "planning_offline/risk/table_file.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kTables = TAUTLINE_SOURCE_DIR "/config/risk/tables";
const std::filesystem::path kGolden =
    TAUTLINE_SOURCE_DIR "/planning_offline/risk/test/golden/risk_tables.json";

InputProblem problemOf(const std::string& text, const std::string& table = {}) {
  try {
    (void)parseRiskTable(text, "table.toml", table);
  } catch (const InputError& e) {
    return e.problem();
  }
  ADD_FAILURE() << "no InputError: " << text;
  return {};
}

double rounded(double value) { return std::round(value * 100.0) / 100.0; }

TEST(RiskOfTable, GoldenTables) {
  const auto golden = nlohmann::json::parse(std::ifstream(kGolden));
  int cases = 0;
  for (const auto& c : golden.at("cases")) {
    const auto elements = c.at("elements").get<std::vector<std::vector<double>>>();
    const TableRisk risk = riskOfTable(elements);
    EXPECT_NEAR(risk.risk, c.at("path_risk").get<double>(), 1e-12) << c.at("id");
    if (c.at("neg_log_success").is_null()) {
      EXPECT_TRUE(std::isinf(risk.cost)) << c.at("id");
    } else {
      EXPECT_NEAR(risk.cost, c.at("neg_log_success").get<double>(), 1e-12) << c.at("id");
    }
    if (c.contains("state_risk")) {
      const auto states = c.at("state_risk").get<std::vector<double>>();
      ASSERT_EQ(risk.state_risk.size(), states.size());
      for (std::size_t i = 0; i < states.size(); ++i)
        EXPECT_NEAR(risk.state_risk[i], states[i], 1e-12) << c.at("id") << " state " << i;
    }
    ++cases;
  }
  EXPECT_EQ(cases, 9);
}

TEST(RiskOfTable, TinyRisksAreNotLost) {
  const TableRisk risk = riskOfTable({{1e-18, 2e-18}, {3e-18}});
  EXPECT_DOUBLE_EQ(risk.risk, 6e-18);
  EXPECT_DOUBLE_EQ(risk.state_risk[0], 3e-18);
}

TEST(RiskOfTable, PublishedPaths) {
  struct Case {
    const char* file;
    double printed;
    double exact;
    std::vector<double> states;  // as printed
  };
  for (const Case& c :
       {Case{"red_path.toml",
             0.714,
             0.7142955047831784,
             {0.04, 0.08, 0.08, 0.08, 0.08, 0.08, 0.14, 0.14, 0.11, 0.16, 0.19}},
        Case{"green_path.toml", 0.575, 0.575225, {0.04, 0.08, 0.08, 0.08, 0.16, 0.12, 0.12, 0.13}},
        Case{"worked_example.toml",
             0.378,
             0.378170,
             {0.01, 0.0, 0.0, 0.04, 0.04, 0.02, 0.11, 0.05, 0.03, 0.03, 0.06, 0.07}}}) {
    const TableRisk risk = riskOfTable(readRiskTable(kTables / c.file));
    EXPECT_NEAR(risk.risk, c.printed, 5e-4) << c.file;
    EXPECT_NEAR(risk.risk, c.exact, 5e-7) << c.file;
    ASSERT_EQ(risk.state_risk.size(), c.states.size()) << c.file;
    for (std::size_t i = 0; i < c.states.size(); ++i)
      EXPECT_NEAR(rounded(risk.state_risk[i]), c.states[i], 1e-12) << c.file << " state " << i;
  }
}

TEST(RiskOfTable, SixthStateOfTheWorkedExample) {
  const TableRisk risk = riskOfTable({{0.04, 0.04, 0.03}});
  EXPECT_NEAR(1.0 - risk.risk, 0.893952, 1e-12);
}

TEST(RiskOfTable, NoProbabilityIsRefused) {
  for (const double bad : {-1e-9, 1.0 + 1e-9, std::nan(""), HUGE_VAL}) {
    try {
      (void)riskOfTable({{0.1}, {0.1, bad}});
      ADD_FAILURE() << bad;
    } catch (const InputError& e) {
      EXPECT_EQ(e.problem().key, "elements[1][1]");
    }
  }
}

TEST(ReadRiskTable, RowsOfAnyLengthAndOtherKeys) {
  EXPECT_EQ(parseRiskTable("risk = 0.7\nelements = [[0.1, 0.2], [1], [0, 0, 0.5]]\n", "f"),
            (std::vector<std::vector<double>>{{0.1, 0.2}, {1}, {0, 0, 0.5}}));
}

TEST(ReadRiskTable, FinishIsTheComplement) {
  const auto elements = parseRiskTable("[e]\nfinish = [0.75, 1, 0]\nstate = {finish = 2}", "f");
  EXPECT_EQ(elements, (std::vector<std::vector<double>>{{0.25}, {0.0}, {1.0}}));
}

TEST(ReadRiskTable, ChoosesTheTable) {
  const std::string text =
      "[a]\nelements = [[0.1]]\n[b]\nfinish = [0.8]\n[c]\nother = 1\n[[d]]\nelements = [[0.3]]\n";
  EXPECT_EQ(parseRiskTable(text, "f", "a"), (std::vector<std::vector<double>>{{0.1}}));
  EXPECT_NEAR(parseRiskTable(text, "f", "b")[0][0], 0.2, 1e-15);
  EXPECT_THAT(problemOf(text).allowed, HasSubstr("a, b"));
  EXPECT_EQ(problemOf(text, "c").key, "c");
  EXPECT_EQ(problemOf(text, "c").line, 5);
  EXPECT_EQ(problemOf(text, "c").allowed, "a, b");
  EXPECT_EQ(problemOf(text, "d").allowed, "a, b");
  EXPECT_EQ(problemOf(text, "nowhere").allowed, "a, b");
  // What stands at the top comes first, and can be told from a named one.
  const std::string both = "elements = [[0.5]]\n[a]\nelements = [[0.1]]\n";
  EXPECT_EQ(parseRiskTable(both, "f")[0][0], 0.5);
  EXPECT_EQ(parseRiskTable(both, "f", "a")[0][0], 0.1);
  EXPECT_EQ(parseRiskTable("[only]\nelements = [[0.4]]\n[x]\ny = 1", "f")[0][0], 0.4);
  EXPECT_THAT(problemOf("elements = [[0.5]]", "a").allowed, HasSubstr("top"));
}

TEST(ReadRiskTable, WrongNumbersAreNamedWithTheirLine) {
  struct Case {
    const char* text;
    const char* key;
    int line;
  };
  for (const Case& c :
       {Case{"elements = [[0.1],\n  [0.2, 1.5]]", "elements[1][1]", 2},
        Case{"elements = [[0.1],\n  [nan]]", "elements[1][0]", 2},
        Case{"[t]\nelements = [[-0.1]]", "t.elements[0][0]", 2},
        Case{"elements = [[0.1],\n\n  []]", "elements[1]", 3},
        Case{"x = 1\nelements = []", "elements", 2}, Case{"elements = [0.1]", "elements[0]", 1},
        Case{"elements = 0.1", "elements", 1},
        Case{"[t]\nx = 1\nfinish = [0.1, \"a\"]", "t.finish[1]", 3},
        Case{"finish = []", "finish", 1},
        Case{"elements = [[0.1]]\nfinish = [0.1]", "finish", 2}}) {
    const InputProblem problem = problemOf(c.text);
    EXPECT_EQ(problem.file, "table.toml") << c.text;
    EXPECT_EQ(problem.key, c.key) << c.text;
    EXPECT_EQ(problem.line, c.line) << c.text;
  }
}

TEST(ReadRiskTable, FilesOfAnotherKindAreRefused) {
  EXPECT_THAT(problemOf("x = 1\n[t]\ny = 2\n").problem, HasSubstr("no table of risks"));
  EXPECT_THAT(problemOf("").problem, HasSubstr("no table of risks"));
  EXPECT_THAT(problemOf("elements = [[0.1], [0.").problem, HasSubstr("not valid TOML"));
  EXPECT_THROW((void)readRiskTable("/nowhere/table.toml"), InputError);
}

}  // namespace
}  // namespace tautline::planning
