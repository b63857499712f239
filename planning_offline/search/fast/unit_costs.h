#pragma once

/// @file
/// Costs of steps on the lattice in whole units, rounded down: sums of them are exact, whatever
/// their order, and never above the sum of the costs that they stand for. Not real-time safe:
/// offline only.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "planning_offline/map/lattice.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

inline constexpr int kLanes = 32;  ///< Directions, filled up to whole vector registers.

/// The tables of CostField in units. A step costs at least one unit, so that walks of no cost end.
class UnitCosts {
 public:
  static constexpr std::uint32_t kForbidden = 0xFFFF;  ///< Locale of a state of infinite cost.
  /// Coarsest unit where the cheapest step is no measure of what is fine enough: what turns and a
  /// state capped at a risk of 0.95 need.
  static constexpr double kUnitMax = 2e-4;
  /// Buckets are no narrower than this [log2 units].
  static constexpr int kShiftMin = 6;

  /// Cost of the access element from one cell to another, rising with character(from) −
  /// character(to); empty = off.
  using Access = std::function<double(CellIndex from, CellIndex to)>;

  /// Chooses the unit: as fine as 16 bits allow for the difference of any two labels of a cell that
  /// matter. Empty if a unit would have to be so coarse that it distorts the result (coarser than
  /// 1/64 of the cheapest step and than kUnitMax), or if a turn or an action has infinite cost.
  [[nodiscard]] static std::optional<UnitCosts> make(const Lattice& lattice, const CostField& costs,
                                                     Access access);

  [[nodiscard]] double unit() const noexcept { return unit_; }
  /// 2^shift() units: width of a bucket. Not above the cheapest step, unless that is below
  /// 2^kShiftMin.
  [[nodiscard]] int shift() const noexcept { return shift_; }
  /// More than any label can be above the start of the bucket that it was made in.
  [[nodiscard]] std::uint32_t reach() const noexcept { return reach_; }
  [[nodiscard]] std::uint32_t turnMax() const noexcept { return turn_max_; }
  /// True if a step was made dearer than it is, to cost a unit.
  [[nodiscard]] bool raised() const noexcept { return raised_; }

  /// Units of a locale cost, before the direction's factor; kForbidden if it is infinite.
  [[nodiscard]] std::uint32_t locale(double cost) const noexcept;

  /// Of locale and action: the step d from a cell to another, given their locale().
  [[nodiscard]] std::uint32_t step(Direction d, std::uint32_t from,
                                   std::uint32_t to) const noexcept {
    const auto i = static_cast<std::size_t>(d);
    return std::max(1U, action[i] + (to * locale_in[i] >> 16) + (from * locale_out[i] >> 16));
  }
  [[nodiscard]] bool hasAccess() const noexcept { return static_cast<bool>(access_); }
  /// Of the access element; comes on top of step().
  [[nodiscard]] std::uint32_t access(CellIndex from, CellIndex to) const {
    return static_cast<std::uint32_t>(access_(from, to) / unit_);
  }

  using Lanes16 = std::array<std::uint16_t, kLanes>;
  using Lanes32 = std::array<std::uint32_t, kLanes>;

  alignas(64) std::array<Lanes16, kDirections + 1> turn{};  ///< [incoming][outgoing]
  /// [p][q]: a label of incoming direction q that is this much above one of p cannot be part of any
  /// better walk: max over the outgoing e of turn[p][e] − turn[q][e].
  alignas(64) std::array<Lanes16, kDirections> dominated{};
  alignas(64) Lanes32 action{};
  alignas(64) Lanes32 locale_in{};   ///< In 1/65536.
  alignas(64) Lanes32 locale_out{};  ///< In 1/65536.

 private:
  UnitCosts() = default;
  void fill(const Lattice& lattice, const CostField& costs, double locale_factor);

  double unit_{1.0};
  double locale_scale_{1.0};  ///< Units of a locale cost of 1.
  int shift_{kShiftMin};
  std::uint32_t reach_{0};
  std::uint32_t turn_max_{0};
  bool raised_{false};
  Access access_;
};

}  // namespace tautline::planning
