#include <algorithm>

#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {

std::vector<CellIndex> LeastRiskTree::pathTo(CellIndex cell) const {
  std::optional<WalkEnd> end = lastOf(cell);
  if (!end) return {};
  std::vector<CellIndex> path{cell};
  while (end->incoming != kNoDirection) {
    end = before(*end);
    path.push_back(end->cell);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace tautline::planning
