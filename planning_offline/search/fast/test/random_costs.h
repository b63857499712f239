#pragma once

/// @file
/// Random lattices and costs, filled by hand: more than risk elements can ask for.

#include <cstdint>
#include <random>
#include <string>

#include "planning_offline/map/lattice.h"
#include "planning_offline/search/fast/unit_costs.h"

namespace tautline::planning::testing {

enum class Turns { kConstant, kLinear, kQuadratic, kThreshold, kAny };

/// What a case is about; every member is part of the seed.
struct CostKind {
  Connectivity connectivity{Connectivity::kVertices};
  bool planar{false};
  Turns turns{Turns::kConstant};
  bool rate{false};  ///< Locale paid for where a step comes from, too, and by its length.
  bool access{false};
  bool free_ways{false};  ///< Steps of no cost exist.
  bool forbidden{false};  ///< Cells of infinite cost exist.

  [[nodiscard]] std::string text() const;
};

struct RandomCosts {
  Lattice lattice;
  CostField field;
  CellIndex start;

  [[nodiscard]] UnitCosts::Access access() const;
  /// The formula of CostField.
  [[nodiscard]] double stepCost(CellIndex u, Direction incoming, Direction d) const;
};

/// `blocked`: part of the cells that is not free.
[[nodiscard]] RandomCosts randomCosts(const GridShape& shape, double blocked, const CostKind& kind,
                                      std::uint32_t seed);

}  // namespace tautline::planning::testing
