#pragma once

/// @file
/// Risk of paths on one map: searches take costs from it, reports take tables from it, and both
/// agree. Not real-time safe: offline only.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/field/map_fields.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/risk/risk_element.h"
#include "planning_offline/risk/risk_params.h"
#include "planning_offline/risk/risk_report.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {

/// What traverse elements other than the tether carry along a path. Both grow only, and risk grows
/// with both: a path that has less of both and less cost can never become the worse one.
struct Accumulators {
  double mud{0.0};     ///< Σ of the slippage layer over the states left behind.
  double energy{0.0};  ///< Used fraction of the battery.
};

/// Costs −log(1 − r) of locale and action elements for moves on the lattice: of the step in
/// direction d from u to v, after an incoming direction p (kNoDirection at the start: no turn),
///
///     locale_out[d] · locale[u] + locale_in[d] · locale[v] + action[d] + turn[p][d] + access(u, v)
///
/// Per-state mode has locale_in = 1, locale_out = 0; rate mode the trapezoid of the rates over the
/// step.
struct CostField {
  std::vector<double> locale;  ///< One a cell, >= 0; infinite where the state is forbidden.
  std::array<double, kDirections> locale_in{};
  std::array<double, kDirections> locale_out{};
  std::array<double, kDirections> action{};
  std::array<std::array<double, kDirections>, kDirections + 1> turn{};  ///< [incoming][outgoing]
  std::vector<float> character;  ///< Of the access element, one a cell; empty if it is off.
  double start_factor{1.0};  ///< Of locale[start] in a path's cost: 1 per state, 0 in rate mode.
};

class RiskModel {
 public:
  /// `fields` must hold what the enabled elements need (neededFields() tells). `string` may be
  /// null: tether elements are then zero. Throws InputError if a layer's value is outside its
  /// domain.
  RiskModel(std::shared_ptr<const VoxelMap> map, MapFields fields, RiskParams params,
            std::shared_ptr<TautString> string);

  [[nodiscard]] const VoxelMap& map() const noexcept { return *map_; }
  [[nodiscard]] const MapFields& fields() const noexcept { return fields_; }
  [[nodiscard]] const RiskParams& params() const noexcept { return params_; }
  [[nodiscard]] const CostField& costs() const noexcept { return costs_; }
  [[nodiscard]] TautString* string() const noexcept { return string_.get(); }
  [[nodiscard]] bool hasTether()
      const noexcept;  ///< A string is there and tether length or contacts have a risk, or a limit.
  [[nodiscard]] bool hasAccumulators() const noexcept;  ///< Slippage or battery is on.

  /// Cost of the access element for a step from u to v of `length` metres; 0 if it is off.
  [[nodiscard]] double accessCost(CellIndex u, CellIndex v) const noexcept;

  /// Cost of locale and action elements of one step on the lattice, access included: the formula of
  /// CostField.
  [[nodiscard]] double stepCost(CellIndex u, Direction incoming, Direction d,
                                CellIndex v) const noexcept;

  /// Cost of a path's first state: locale, and traverse for a tether of this length and number of
  /// contacts.
  [[nodiscard]] double startCost(CellIndex start) const noexcept;

  /// Cost of tether length and contacts at a state reached by a step of `step` metres (0 at the
  /// start, where rate mode has none). Infinite beyond a tether limit (elevation is asked
  /// separately).
  [[nodiscard]] double tetherCost(double length, int contacts, double step) const noexcept;

  /// False if the vehicle at `position` is below the least elevation seen from `anchor`.
  [[nodiscard]] bool elevationAllowed(const Eigen::Vector3d& anchor,
                                      const Eigen::Vector3d& position) const noexcept;

  /// Accumulators after the step from u to v of `step` metres, and the cost of slippage and battery
  /// at v with them.
  [[nodiscard]] Accumulators advance(const Accumulators& before, CellIndex u, CellIndex v,
                                     double step) const noexcept;
  [[nodiscard]] double accumulatorCost(const Accumulators& at, CellIndex v,
                                       double step) const noexcept;

  /// The table of a path given by points in M [m], each inside the map; elements by definition,
  /// sharing no code with the step costs but the elements' own functions. Points need not be
  /// neighbours or cell centres. In rate mode long steps are integrated cell by cell.
  [[nodiscard]] RiskReport evaluate(std::span<const Eigen::Vector3d> points) const;
  [[nodiscard]] RiskReport evaluate(std::span<const CellIndex> cells) const;

 private:
  std::shared_ptr<const VoxelMap> map_;
  MapFields fields_;
  RiskParams params_;
  std::shared_ptr<TautString> string_;
  CostField costs_;
};

}  // namespace tautline::planning
