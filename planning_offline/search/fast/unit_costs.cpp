#include "planning_offline/search/fast/unit_costs.h"

#include <cmath>
#include <limits>
#include <utility>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr double kOffsetMax = 65000.0;  // units between labels of a cell, below 2^16 - 1
// Units that rounding may take off a step: each locale term is rounded three times, the action
// once.
constexpr double kRounding = 8.0;

std::size_t at(Direction d) { return static_cast<std::size_t>(d); }

/// Least and greatest cost of one step, and of a turn.
struct CostRange {
  double step_min{std::numeric_limits<double>::infinity()};
  double step_max{0.0};
  double turn_max{0.0};
  double factor_max{0.0};  ///< Of locale_in and locale_out.
};

CostRange rangeOf(const Lattice& lattice, const CostField& costs, const UnitCosts::Access& access) {
  double locale_min = std::numeric_limits<double>::infinity();
  double locale_max = 0.0;
  CellIndex wide = kNoCell;  // the cells that a step between would have the dearest access
  CellIndex narrow = kNoCell;
  for (std::size_t i = 0; i < costs.locale.size(); ++i) {
    const auto cell = static_cast<CellIndex>(i);
    if (!lattice.free(cell) || !std::isfinite(costs.locale[i])) continue;
    locale_min = std::min(locale_min, costs.locale[i]);
    locale_max = std::max(locale_max, costs.locale[i]);
    if (!access) continue;
    if (wide == kNoCell || costs.character[i] > costs.character[static_cast<std::size_t>(wide)])
      wide = cell;
    if (narrow == kNoCell || costs.character[i] < costs.character[static_cast<std::size_t>(narrow)])
      narrow = cell;
  }
  if (locale_min > locale_max) locale_min = locale_max;
  const double access_max = wide == kNoCell ? 0.0 : access(wide, narrow);

  CostRange range;
  for (const Direction d : lattice.directions()) {
    const double factor = costs.locale_in[at(d)] + costs.locale_out[at(d)];
    range.step_min = std::min(range.step_min, costs.action[at(d)] + factor * locale_min);
    range.step_max =
        std::max(range.step_max, costs.action[at(d)] + factor * locale_max + access_max);
    range.factor_max =
        std::max({range.factor_max, costs.locale_in[at(d)], costs.locale_out[at(d)]});
    for (const auto& row : costs.turn) range.turn_max = std::max(range.turn_max, row[at(d)]);
  }
  return range;
}

}  // namespace

std::optional<UnitCosts> UnitCosts::make(const Lattice& lattice, const CostField& costs,
                                         Access access) {
  const CostRange range = rangeOf(lattice, costs, access);
  // Labels of a cell differ by a bucket, a step and two turns; a third turn is added to them.
  const double span = range.step_max + 3.0 * range.turn_max;
  if (!std::isfinite(span)) return std::nullopt;

  UnitCosts units;
  units.access_ = std::move(access);
  const double step_units = range.step_min * kOffsetMax / (range.step_min + span);  // at the finest
  if (step_units >= std::ldexp(1.0, kShiftMin) + kRounding) {
    units.shift_ = static_cast<int>(std::floor(std::log2(step_units - kRounding)));
    units.unit_ = range.step_min / (std::ldexp(1.0, units.shift_) + kRounding);
  } else {
    units.unit_ = std::max(span / (kOffsetMax - std::ldexp(1.0, kShiftMin)),
                           std::numeric_limits<double>::min());
    if (units.unit_ > kUnitMax) return std::nullopt;
  }
  units.raised_ = range.step_min < kRounding * units.unit_;
  units.fill(lattice, costs, std::max(range.factor_max, 1e-9));
  units.reach_ = (std::uint32_t{1} << units.shift_) +
                 static_cast<std::uint32_t>((range.step_max + range.turn_max) / units.unit_) + 2;
  return units;
}

void UnitCosts::fill(const Lattice& lattice, const CostField& costs, double locale_factor) {
  const auto down = [&](double cost) { return static_cast<std::uint32_t>(cost / unit_); };
  locale_scale_ = locale_factor / unit_;
  const auto factor = [&](double f) {
    return static_cast<std::uint32_t>(65536.0 * f / locale_factor);
  };
  for (const Direction d : lattice.directions()) {
    action[at(d)] = down(costs.action[at(d)]);
    locale_in[at(d)] = factor(costs.locale_in[at(d)]);
    locale_out[at(d)] = factor(costs.locale_out[at(d)]);
    for (std::size_t p = 0; p <= kDirections; ++p) {
      turn[p][at(d)] = static_cast<std::uint16_t>(down(costs.turn[p][at(d)]));
      turn_max_ = std::max<std::uint32_t>(turn_max_, turn[p][at(d)]);
    }
  }
  for (const Direction p : lattice.directions()) {
    for (const Direction q : lattice.directions()) {
      int most = 0;
      for (const Direction e : lattice.directions())
        most = std::max(most, turn[at(p)][at(e)] - turn[at(q)][at(e)]);
      dominated[at(p)][at(q)] = static_cast<std::uint16_t>(most);
    }
  }
}

std::uint32_t UnitCosts::locale(double cost) const noexcept {
  if (!std::isfinite(cost)) return kForbidden;
  return static_cast<std::uint32_t>(cost * locale_scale_);
}

}  // namespace tautline::planning
