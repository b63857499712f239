#include "app/experiments/calibration.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "app/experiments/cluttered_map.h"
#include "common/toml/config_file.h"

namespace tautline::experiments {
namespace {

using planning::RiskElement;

std::vector<CostOutcome> synthetic(const Eigen::VectorXd& factors, int paths, std::int64_t flights,
                                   unsigned seed) {
  std::mt19937 dice(seed);
  const auto chance = [&] { return static_cast<double>(dice()) / 4294967296.0; };
  std::vector<CostOutcome> rows;
  for (int i = 0; i < paths; ++i) {
    CostOutcome row;
    row.cost.resize(factors.size());
    for (double& c : row.cost) c = 0.3 * chance();
    row.flights = flights;
    for (std::int64_t n = 0; n < flights; ++n)
      row.failed += chance() < riskWith(factors, row.cost) ? 1 : 0;
    rows.push_back(std::move(row));
  }
  return rows;
}

TEST(RiskFit, FindsTheFactorsThatTheFlightsWereDrawnWith) {
  Eigen::VectorXd truth(4);
  truth << 0.5, 2.0, 0.0, 1.2;
  const Eigen::VectorXd found = fitFactors(synthetic(truth, 300, 300, 1));
  for (Eigen::Index k = 0; k < 4; ++k) {
    EXPECT_NEAR(found[k], truth[k], 0.08);
    EXPECT_GE(found[k], 0.0);
  }
}

/// No step along an axis that is allowed makes the flights likelier.
TEST(RiskFit, IsTheMaximum) {
  Eigen::VectorXd truth(3);
  truth << 0.0, 1.5, 0.7;
  const std::vector<CostOutcome> rows = synthetic(truth, 40, 20, 2);
  const double scale = fitScale(rows);
  const Eigen::VectorXd found = fitFactors(rows, 1.0);
  const auto value = [&](const Eigen::VectorXd& a) {
    return logLikelihood(rows, a) - 0.5 * ((a / scale).array() - 1.0).matrix().squaredNorm();
  };
  for (Eigen::Index k = 0; k < 3; ++k) {
    for (const double step : {-1e-3, 1e-3}) {
      Eigen::VectorXd other = found;
      other[k] = std::max(0.0, other[k] + step);
      EXPECT_LE(value(other), value(found) + 1e-9);
    }
  }
}

TEST(RiskFit, OneScaleIsTheLikeliest) {
  const std::vector<CostOutcome> rows = synthetic(Eigen::VectorXd::Constant(2, 0.8), 200, 200, 3);
  const double scale = fitScale(rows);
  EXPECT_NEAR(scale, 0.8, 0.03);
  const auto at = [&](double s) { return logLikelihood(rows, Eigen::VectorXd::Constant(2, s)); };
  EXPECT_GT(at(scale), at(scale * 1.01));
  EXPECT_GT(at(scale), at(scale * 0.99));
}

/// Collinear elements share what they explain together.
TEST(RiskFit, ElementsThatComeTogetherGetTheSameFactor) {
  std::vector<CostOutcome> rows = synthetic(Eigen::VectorXd::Constant(1, 1.3), 50, 100, 4);
  for (CostOutcome& row : rows) row.cost = Eigen::VectorXd::Constant(2, 0.5 * row.cost[0]);
  const Eigen::VectorXd found = fitFactors(rows);
  EXPECT_NEAR(found[0], found[1], 1e-6);
  EXPECT_NEAR(found[0], 1.3, 0.1);
}

TEST(RiskFit, FlightsThatAllEndAlikeSayThatAllDo) {
  std::vector<CostOutcome> rows = synthetic(Eigen::VectorXd::Constant(2, 1.0), 20, 10, 6);
  for (CostOutcome& row : rows) row.failed = 0;
  EXPECT_NEAR(riskWith(fitFactors(rows), rows[0].cost), 0.0, 1e-6);
  for (CostOutcome& row : rows) row.failed = row.flights;
  EXPECT_NEAR(riskWith(fitFactors(rows), rows[0].cost), 1.0, 1e-6);
}

planning::RiskParams published() {
  return loadConfig<planning::RiskParams>(TAUTLINE_SOURCE_DIR "/config/risk/dissertation.toml");
}

/// Paths as they are planned, flown in a world where other parameters are the truth.
TEST(Calibration, FindsTheParametersOfAWorldThatObeysTheModel) {
  constexpr std::uint64_t kSeed = 5;
  constexpr std::int64_t kFlights = 100000;
  planning::PerElement truth;
  truth.fill(1.0);
  truth[static_cast<std::size_t>(RiskElement::kDistance)] = 2.0;
  truth[static_cast<std::size_t>(RiskElement::kActionLength)] = 0.4;
  truth[static_cast<std::size_t>(RiskElement::kTurn)] = 0.5;
  std::vector<TruthPath> paths;
  for (int map = 0; map < 8; ++map) {
    const planning::RiskSpace space = truthSpace(map, kSeed, published());
    for (const Eigen::Vector3d& goal : goalsIn(space, 6, 1.0, 3)) {
      for (const char* planner : kTruthPlanners) {
        const PlannedPath path = planPath(space, planner, *space.space.map->start, goal);
        if (path.found()) paths.push_back({.map = map, .planner = planner, .points = path.points});
      }
    }
  }
  paths = reassess(paths, kSeed, scaled(published(), truth));
  for (TruthPath& p : paths) {
    const auto failed = static_cast<std::int64_t>(std::llround(p.prediction.risk * kFlights));
    p.ends[static_cast<std::size_t>(FlightEnd::kObstacle)] = failed;
    p.ends[static_cast<std::size_t>(FlightEnd::kFinished)] = kFlights - failed;
  }
  const CalibratedRisk found = calibrate(paths, kSeed, published());
  for (const RiskElement e : elementsOf(paths)) {
    EXPECT_NEAR(found.factors[static_cast<std::size_t>(e)], truth[static_cast<std::size_t>(e)], 0.1)
        << nameOf(e, planning::kRiskElementNames);
  }
  for (const TruthPath& p : reassess(paths, kSeed, found.params))
    EXPECT_NEAR(p.prediction.risk, static_cast<double>(p.failed()) / kFlights, 0.005);
}

TEST(Calibration, ParametersStayInTheirRange) {
  planning::PerElement huge;
  huge.fill(1e6);
  const planning::RiskParams params = scaled(published(), huge);
  EXPECT_NO_THROW((void)parseConfig<planning::RiskParams>(dumpConfig(params), "scaled"));
  EXPECT_EQ(params.distance.member.risk, 1.0);
  EXPECT_EQ(params.quantum, 0.0);
}

}  // namespace
}  // namespace tautline::experiments
