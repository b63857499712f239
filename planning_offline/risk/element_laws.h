#pragma once

/// @file
/// The formula of each risk element (docs/risk.md), from the quantity it judges to the elementary
/// risk of one state. The only place where they stand: costs for searches and reports both call
/// them. Results are rounded to the quantum and capped.
///
/// What is certain is never rounded or capped: a locale element or the battery at exactly 1, and a
/// tether beyond a limit. Not real-time safe: offline only.

#include <Eigen/Core>

#include "planning_offline/risk/risk_params.h"

namespace tautline::planning {

// Locale. In rate mode: risk of a reference step through such states.
[[nodiscard]] double distanceRisk(const RiskParams& params, double distance);      ///< [m]
[[nodiscard]] double scaleRisk(const RiskParams& params, double width);            ///< E_cd [m]
[[nodiscard]] double visibilityRisk(const RiskParams& params, double visibility);  ///< [m]
[[nodiscard]] double threatRisk(const RiskParams& params, double per_second);      ///< in [0, 1]
[[nodiscard]] double singularityRisk(const RiskParams& params, double elevation);  ///< [rad]
[[nodiscard]] double layerRisk(const RiskParams& params, const LayerParams& layer, double value);

// Action. In rate mode lengths and turns have costs of their own: below.
[[nodiscard]] double actionLengthRisk(const RiskParams& params, double length);  ///< [m]
/// Actions in metres; 0 if either is no move.
[[nodiscard]] double turnRisk(const RiskParams& params, const Eigen::Vector3d& previous,
                              const Eigen::Vector3d& action);
[[nodiscard]] double accessRisk(const RiskParams& params,
                                double lost);  ///< Of character [m], >= 0.

// Traverse.
[[nodiscard]] double tetherLengthRisk(const RiskParams& params, double length);  ///< [m]
[[nodiscard]] double contactsRisk(const RiskParams& params, int contacts);
[[nodiscard]] double slippageRisk(const RiskParams& params, double mud, double layer);
[[nodiscard]] double batteryRisk(const RiskParams& params, double used);  ///< Fraction, >= 0.

/// Mud that a step of `step` metres adds, between states with these layer values: that of the state
/// it leaves; in rate mode the trapezoid over step / reference_step.
[[nodiscard]] double mudGathered(const RiskParams& params, double left, double reached,
                                 double step);
/// Fraction of the battery that a straight move [m] takes.
[[nodiscard]] double energyUsed(const RiskParams& params, const Eigen::Vector3d& move);

// Costs of a step by the mode. Per state they are −log(1 − r) of the above.
/// Rate mode: the same per metre whatever the step, such that a reference step has its elementary
/// risk.
[[nodiscard]] double actionLengthCost(const RiskParams& params, double length);
/// Rate mode: of the unit vectors.
[[nodiscard]] double turnCost(const RiskParams& params, const Eigen::Vector3d& previous,
                              const Eigen::Vector3d& action);
/// Rate mode: per_unit · lost, so that it does not matter in how many steps it is lost.
[[nodiscard]] double accessCost(const RiskParams& params, double lost);

}  // namespace tautline::planning
