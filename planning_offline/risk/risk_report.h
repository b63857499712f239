#pragma once

/// @file
/// What a path risks, state by state and element by element: the dissertation's table.
///
///     risk(P) = 1 − Π_i Π_k (1 − r_k(s_0 … s_i)),  state 0 included
///
/// Sums are of costs −log(1 − r); r = 1 has infinite cost: certain failure. Not real-time safe:
/// offline only.

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/risk/risk_element.h"

namespace tautline::planning {

/// −log(1 − r), r in [0, 1]. Exact for tiny r.
[[nodiscard]] inline double costOfRisk(double r) noexcept { return -std::log1p(-r); }
/// 1 − exp(−cost), cost >= 0 or infinite. Exact for tiny costs.
[[nodiscard]] inline double riskOfCost(double cost) noexcept { return -std::expm1(-cost); }

struct StateRisk {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};  ///< M [m].
  PerElement elements{};                              ///< r_k in [0, 1].
  double risk{0.0};                                   ///< 1 − Π_k (1 − r_k)
  double tether_length{0.0};  ///< Taut, along the contacts [m]; 0 without a tether model.
  std::vector<Eigen::Vector3d> contacts;  ///< From the reel to the vehicle, M [m].
};

struct RiskReport {
  std::vector<StateRisk> states;
  double cost{0.0};           ///< Σ −log(1 − r)
  double risk{0.0};           ///< 1 − exp(−cost)
  PerElement element_cost{};  ///< Part of `cost` that each element has.
};

/// The report of a table of elementary risks, one row a state, any number of columns: only `risk`
/// of each row and the path's cost and risk. Used for the published tables. Throws InputError if a
/// number is outside [0, 1].
struct TableRisk {
  std::vector<double> state_risk;
  double cost{0.0};
  double risk{0.0};
};
[[nodiscard]] TableRisk riskOfTable(const std::vector<std::vector<double>>& elements);

}  // namespace tautline::planning
