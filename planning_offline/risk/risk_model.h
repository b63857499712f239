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
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/risk/risk_element.h"
#include "planning_offline/risk/risk_params.h"
#include "planning_offline/risk/risk_report.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {

/// What traverse elements other than the tether carry along a path. Both grow only, and risk grows
/// with both: a path that has less of both and less cost can never become the worse one.
struct Accumulators {
  double mud{0.0};     ///< Σ of the slippage layer over the states left behind; in rate mode its
                       ///< integral along the way over reference_step.
  double energy{0.0};  ///< Used fraction of the battery.
};

/// Costs −log(1 − r) of locale and action elements for moves on the lattice: of the step in
/// direction d from u to v, after an incoming direction p (kNoDirection at the start: no turn),
///
///     locale_out[d] · locale[u] + locale_in[d] · locale[v] + action[d] + turn[p][d] + access(u, v)
///
/// Per-state mode has locale_in = 1, locale_out = 0; rate mode the trapezoid of the rates over the
/// step. A state of infinite cost is forbidden: no search may leave it.
struct CostField {
  std::vector<double> locale;  ///< One a cell, >= 0; infinite where the state is forbidden.
  std::array<double, kDirections> locale_in{};
  std::array<double, kDirections> locale_out{};
  std::array<double, kDirections> action{};
  std::array<std::array<double, kDirections>, kDirections + 1> turn{};  ///< [incoming][outgoing]
  std::vector<float> character;  ///< Of the access element, one a cell; empty if it is off.
  double start_factor{1.0};  ///< Of locale[start] in a path's cost: 1 per state, 0 in rate mode.
};

/// Which hard limits of the tether are broken.
struct BrokenLimits {
  bool length{false};
  bool contacts{false};
  bool elevation{false};
  bool no_contact{false};  ///< A contact on a cell of VoxelMap::no_contact.

  [[nodiscard]] bool any() const noexcept { return length || contacts || elevation || no_contact; }
  BrokenLimits& operator|=(const BrokenLimits& other) noexcept {
    length |= other.length;
    contacts |= other.contacts;
    elevation |= other.elevation;
    no_contact |= other.no_contact;
    return *this;
  }
};

/// Which fields the elements that are on need, up to the values where their risk ends. Unknown
/// space and threads are left to the caller.
[[nodiscard]] FieldRequest neededFields(const RiskParams& params, const VoxelMap& map);

class RiskModel {
 public:
  /// `fields` must hold what the enabled elements need (neededFields() tells). `string` may be
  /// null: tether elements are then zero. A layer that the map does not have is zero. Throws
  /// InputError if a layer's value is outside [0, 1], its size is not the map's, or its name is
  /// that of no element that reads a layer.
  RiskModel(std::shared_ptr<const VoxelMap> map, MapFields fields, RiskParams params,
            std::shared_ptr<TautString> string);

  [[nodiscard]] const VoxelMap& map() const noexcept { return *map_; }
  [[nodiscard]] const MapFields& fields() const noexcept { return fields_; }
  [[nodiscard]] const RiskParams& params() const noexcept { return params_; }
  [[nodiscard]] const CostField& costs() const noexcept { return costs_; }
  [[nodiscard]] TautString* string() const noexcept { return string_.get(); }
  /// A string is there and tether length or contacts have a risk, or there is a limit.
  [[nodiscard]] bool hasTether() const noexcept;
  [[nodiscard]] bool hasAccumulators() const noexcept;  ///< Slippage or battery is on.

  /// Elements that can be more than zero with these parameters and this string, in the order of the
  /// enumeration.
  [[nodiscard]] const std::vector<RiskElement>& enabled() const noexcept { return enabled_; }

  /// Elementary risk of a locale element in a cell, rounded and capped; 0 if it is off. Rate mode:
  /// of a reference step through such cells.
  [[nodiscard]] double localeRisk(RiskElement element, CellIndex cell) const;

  /// Cost of the access element for a step from u to v; 0 if it is off.
  [[nodiscard]] double accessCost(CellIndex u, CellIndex v) const noexcept;

  /// Cost of locale and action elements of one step on the lattice, access included: the formula of
  /// CostField.
  [[nodiscard]] double stepCost(CellIndex u, Direction incoming, Direction d,
                                CellIndex v) const noexcept;

  /// Cost of a path's first state but for the tether's, which is startShare(tetherCost(…)): its
  /// locale; in rate mode 0. Infinite if the state is forbidden.
  [[nodiscard]] double startCost(CellIndex start) const noexcept;

  /// −log(1 − r) of tether length and contacts in a state; infinite beyond their limits (elevation
  /// and forbidden contacts are asked separately). What a path pays for it: overStep(),
  /// startShare().
  [[nodiscard]] double tetherCost(double length, int contacts) const noexcept;

  /// What a step of `step` metres costs between states of these costs (locale, tether,
  /// accumulators): per state that of the one it reaches; in rate mode the trapezoid, (before +
  /// after) / 2 · step / reference_step. `before` is finite.
  [[nodiscard]] double overStep(double before, double after, double step) const noexcept;

  /// What a path pays for the cost of its first state: all of it per state, nothing in rate mode.
  /// Infinite stays infinite.
  [[nodiscard]] double startShare(double cost) const noexcept;

  /// False if the vehicle at `position` is below the least elevation seen from `anchor`. At the
  /// anchor itself it is not.
  [[nodiscard]] bool elevationAllowed(const Eigen::Vector3d& anchor,
                                      const Eigen::Vector3d& position) const noexcept;

  /// The limits that the state is beyond: each is an infinite cost. There must be a string.
  [[nodiscard]] BrokenLimits brokenLimits(StackId stack, const Eigen::Vector3d& position) const;

  /// Accumulators after the step from u to v of `step` metres.
  [[nodiscard]] Accumulators advance(const Accumulators& before, CellIndex u, CellIndex v,
                                     double step) const noexcept;

  /// −log(1 − r) of slippage and battery in cell v with these accumulators; a path pays overStep()
  /// of it, and nothing at its start.
  [[nodiscard]] double accumulatorCost(const Accumulators& at, CellIndex v) const noexcept;

  /// The table of a path given by points in M [m], each inside the map; elements by definition,
  /// sharing no code with the step costs but the elements' own formulas. Points need not be
  /// neighbours or cell centres. Without points: an empty table of no risk.
  ///
  /// Per state: a state's locale is that of the cell that holds it. Rate mode: the rates are
  /// interpolated between the centres of the cells around (only those in the same CellState as the
  /// cell that holds the point; a cell forbids only inside itself), and integrated by the trapezoid
  /// in pieces of at most a cell along each axis. Both are what the step costs say for steps on the
  /// lattice. A path beyond a tether limit has risk 1 in the column of the tether length (also for
  /// the elevation) or the contacts (also for forbidden ones).
  [[nodiscard]] RiskReport evaluate(std::span<const Eigen::Vector3d> points) const;
  [[nodiscard]] RiskReport evaluate(std::span<const CellIndex> cells) const;

 private:
  friend class PathEvaluation;
  void readLayers();
  void makeLocaleCosts();
  void makeStepCosts();
  /// Value of the layer of an element in a cell, 0 without it.
  [[nodiscard]] double layer(RiskElement element, CellIndex cell) const noexcept;
  /// Character of the access element in a cell [m].
  [[nodiscard]] double character(CellIndex cell) const noexcept;

  std::shared_ptr<const VoxelMap> map_;
  MapFields fields_;
  RiskParams params_;
  std::shared_ptr<TautString> string_;
  std::array<const std::vector<double>*, kRiskElements> layers_{};  ///< Into map_; null = absent.
  std::vector<RiskElement> enabled_;
  CostField costs_;
};

}  // namespace tautline::planning
