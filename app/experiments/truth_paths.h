#pragma once

/// @file
/// Planned paths through many cluttered rooms, flown many times: what is predicted and what came of
/// it, and how well measures of risk forecast it. docs/risk_campaign.md. Not real-time safe.

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/experiments/binomial.h"
#include "app/experiments/flight_campaign.h"
#include "app/experiments/planned_path.h"
#include "app/experiments/risk_fit.h"
#include "planning_offline/risk/risk_params.h"

namespace tautline::experiments {

/// Which paths: in each room to each goal by each of both planners.
struct TruthOptions {
  int maps{12};
  int goals{4};
  std::int64_t flights{20};  ///< Of a path.
  std::uint64_t seed{1};     ///< Of maps, goals and flights.
};

inline constexpr std::array kTruthPlanners{"directional", "additive"};

struct TruthCase {
  int map{0};
  int goal{0};
  const char* planner{kTruthPlanners[0]};

  [[nodiscard]] std::string name() const;
};
[[nodiscard]] std::vector<TruthCase> truthCases(const TruthOptions& options);

/// The room of a case: the higher its number in the round of eight, the more things are in it.
[[nodiscard]] planning::RiskSpace truthSpace(int map, std::uint64_t seed,
                                             const planning::RiskParams& params);

/// What came of a case.
struct TruthPath {
  int map{0};
  std::string planner{};
  std::vector<Eigen::Vector3d> points{};  ///< M [m]; empty: there is no such path.
  Prediction prediction{};
  std::array<std::int64_t, kFlightEndNames.size()> ends{};

  [[nodiscard]] std::int64_t flights() const noexcept;  ///< That were started.
  [[nodiscard]] std::int64_t failed() const noexcept;
  [[nodiscard]] Forecast forecast(double predicted) const {
    return {predicted, failed(), flights()};
  }
};
[[nodiscard]] nlohmann::json toJson(const TruthPath& path);
[[nodiscard]] TruthPath truthPathFrom(const nlohmann::json& json);

/// Plans the path and flies it; `who` gives station and plant.
[[nodiscard]] TruthPath flyTruthCase(const TruthCase& c, const TruthOptions& options,
                                     const planning::RiskParams& params, const CampaignFlight& who);

/// The costs that the elements that `paths` have at all gave their risks: rows for fitFactors().
[[nodiscard]] std::vector<planning::RiskElement> elementsOf(const std::vector<TruthPath>& paths);
[[nodiscard]] std::vector<CostOutcome> outcomesOf(
    const std::vector<TruthPath>& paths, const std::vector<planning::RiskElement>& elements);
/// The same with the additive measure as the only cost.
[[nodiscard]] std::vector<CostOutcome> additiveOutcomes(const std::vector<TruthPath>& paths);

/// A measure of risk and its forecasts for paths that it has not seen.
struct Measure {
  std::string name;
  std::vector<Forecast> forecasts;
};
enum MeasureIndex : std::size_t {
  kIndex,           ///< The risk index as it stands.
  kAdditive,        ///< The additive measure, read as a probability by the union bound.
  kIndexScaled,     ///< The index with one factor for all costs, fitted on `seen`.
  kAdditiveScaled,  ///< 1 − exp(−s · additive measure), s fitted on `seen`: as much freedom.
  kIndexFitted,     ///< The index with a factor for each element, fitted on `seen`.
  kBaseRate,        ///< The share of failures in `seen`, whatever the path: no skill at all.
  kMeasures
};
/// All measures, for `judged`; `seen` is not empty. Where all of it ended alike, fits say that all
/// does.
[[nodiscard]] std::array<Measure, kMeasures> measure(const std::vector<TruthPath>& seen,
                                                     const std::vector<TruthPath>& judged);

/// Both failures and successes are there, as fits need.
[[nodiscard]] bool canFit(const std::vector<TruthPath>& paths);

/// Rooms of even and of odd number.
struct Halves {
  std::vector<TruthPath> even;
  std::vector<TruthPath> odd;
};
/// Paths that were flown.
[[nodiscard]] Halves halve(const std::vector<TruthPath>& paths);

}  // namespace tautline::experiments
