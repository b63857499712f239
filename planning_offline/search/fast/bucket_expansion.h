#pragma once

/// @file
/// The hot loop of the fast search: all cells of one bucket, for the processor's widest vectors.
/// Not real-time safe: offline only.

#include <array>
#include <cstddef>
#include <cstdint>

#include "planning_offline/map/lattice.h"
#include "planning_offline/search/fast/directional_labels.h"
#include "planning_offline/search/fast/free_cells.h"
#include "planning_offline/search/fast/unit_costs.h"

namespace tautline::planning {

/// What the loop works on.
struct BucketExpansion {
  const Lattice& lattice;
  const UnitCosts& units;
  const FreeCells& numbers;
  CellLabels* labels;  ///< By number.
  Gate* gates;         ///< By number; [-1] and [count] exist.
  BucketQueue& queue;
};

/// Expands the labels of `bucket`, those too that this brings into it. Returns how many times a
/// cell was expanded.
std::size_t expandBucket(const BucketExpansion& search, std::uint32_t bucket);

/// The first action: from the start in all directions.
void expandStart(const BucketExpansion& search, CellIndex start, std::uint32_t start_locale);

}  // namespace tautline::planning
