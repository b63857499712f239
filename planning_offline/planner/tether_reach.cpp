#include "planning_offline/planner/tether_reach.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.h"
#include "planning_offline/planner/contact_bound.h"
#include "planning_offline/search/path_tethers.h"

namespace tautline::planning {
namespace {

/// Nothing but the way costs: the least-risk paths are the shortest.
RiskParams shortestWays(const TetherLimits& limits) {
  RiskParams params;
  params.mode = RiskMode::kRate;  // proportional to the way
  params.distance.member.risk = 0.0;
  params.visibility.member.risk = 0.0;
  params.turn.risk = 0.0;
  params.tether_length.per_metre = 0.0;
  params.contacts.each = 0.0;
  params.tether_limits = limits;
  return params;
}

/// What the ways looked at so far have shown of every cell.
class Ways {
 public:
  Ways(std::shared_ptr<const VoxelMap> map, const TetherLimits& limits)
      : risk_(map, MapFields{}, shortestWays(limits), makeTautString(*map, *map->reel)),
        contacts_(map->shape.size(), -1),
        shown_(map->shape.size(), 0) {}

  /// Adds the shortest ways on a lattice.
  void add(const Lattice& lattice, CellIndex take_off, const Progress& progress) {
    const auto tree = leastRiskTree(lattice, risk_, take_off, 0, progress);
    const PathTethers tethers = tethersOfPaths(lattice, risk_, *tree, progress);
    complete_ = complete_ && tethers.complete;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const std::int32_t contacts = tethers.contacts_most[i];
      if (contacts < 0) continue;
      shown_[i] |= kConnected;
      if (tethers.contact_allowed[i] == 0) continue;
      if (contacts_[i] < 0 || contacts < contacts_[i]) contacts_[i] = contacts;
      const bool length = tethers.length_allowed[i] != 0;
      const bool elevation = tethers.elevation_allowed[i] != 0;
      shown_[i] |= static_cast<std::uint8_t>((length ? kLength : 0) | (elevation ? kElevation : 0) |
                                             (length && elevation ? kBoth : 0));
    }
  }

  /// Of a cell: some way leads there, and some way off all forbidden surfaces is within the limits.
  enum Shown : std::uint8_t { kConnected = 1, kLength = 2, kElevation = 4, kBoth = 8 };
  [[nodiscard]] bool shown(std::size_t i, Shown what) const { return (shown_[i] & what) != 0; }
  [[nodiscard]] std::vector<std::int32_t>& contacts() noexcept { return contacts_; }
  [[nodiscard]] bool complete() const noexcept { return complete_; }

 private:
  RiskModel risk_;
  std::vector<std::int32_t> contacts_;
  std::vector<std::uint8_t> shown_;
  bool complete_{true};
};

/// Adds the shortest ways through the cells whose straight tether is within the limits, by each
/// limit alone and by both, from where such a way begins nearest to the reel. The shortest way of
/// all may cut a corner below the least elevation that a straight tether keeps above.
void addWaysWithin(const VoxelMap& map, const Lattice& lattice, const ReachMap& reach,
                   const TetherLimits& limits, const Progress& progress, Ways& ways) {
  const bool length = limits.length_max > 0.0;
  const bool elevation = limits.elevation_min > -90.0;
  std::vector<TetherLimits> sets;
  if (length) sets.push_back({.length_max = limits.length_max});
  if (elevation) sets.push_back({.elevation_min = limits.elevation_min});
  if (length && elevation) sets.push_back(limits);
  for (const TetherLimits& set : sets) {
    std::vector<std::uint8_t> cells = reach.straight;
    CellIndex first = kNoCell;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i] == 0) continue;
      const Eigen::Vector3d vehicle = map.centre(static_cast<CellIndex>(i));
      const double distance = (vehicle - *map.reel).norm();
      if (!set.allowsLength(distance) || !set.allowsElevation(*map.reel, vehicle)) {
        cells[i] = 0;
      } else if (distance < nearest) {
        nearest = distance;
        first = static_cast<CellIndex>(i);
      }
    }
    if (first != kNoCell)
      ways.add(Lattice(map.shape, lattice.connectivity(), std::move(cells)), first, progress);
  }
}

/// Cells by the least number of contacts: [k] with at most k.
std::vector<ReachBounds> countContacts(const VoxelMap& map, const Ways& ways,
                                       const std::vector<std::int32_t>& contacts, int contacts_max,
                                       const Progress& progress) {
  constexpr std::size_t kAskEvery = 65536;
  const std::int32_t most = *std::max_element(contacts.begin(), contacts.end());
  const std::int32_t last = contacts_max >= 0 ? contacts_max : std::max(most, 0);
  std::vector<ReachBounds> out(static_cast<std::size_t>(last) + 1);
  ContactBound bound(map, *map.reel);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (i % kAskEvery == 0) {
      progress.report("least contacts",
                      static_cast<double>(i) / static_cast<double>(contacts.size()));
      if (progress.cancelled()) break;
    }
    if (!ways.shown(i, Ways::kConnected)) continue;
    const std::int32_t least = bound.at(static_cast<CellIndex>(i));
    if (contacts[i] >= 0 && contacts[i] <= last)
      ++out[static_cast<std::size_t>(contacts[i])].reached;
    if (least <= last) ++out[static_cast<std::size_t>(least)].at_most;
  }
  for (std::size_t k = 1; k < out.size(); ++k) {
    out[k].reached += out[k - 1].reached;
    out[k].at_most += out[k - 1].at_most;
  }
  return out;
}

}  // namespace

TetherReach tetherReach(const std::shared_ptr<const VoxelMap>& map, const Lattice& lattice,
                        const ReachMap& reach, const TetherLimits& limits,
                        const Progress& progress) {
  TAUTLINE_CHECK(map->reel.has_value());
  TetherReach out;
  Ways ways(map, limits);
  if (reach.take_off != kNoCell) {
    ways.add(lattice, reach.take_off, progress);
    const Lattice seen(map->shape, lattice.connectivity(), reach.straight);
    ways.add(seen, reach.take_off, progress);
    addWaysWithin(*map, lattice, reach, limits, progress, ways);
  }
  out.contacts = std::move(ways.contacts());
  for (std::size_t i = 0; i < out.contacts.size(); ++i) {
    if (!ways.shown(i, Ways::kConnected)) continue;
    const double distance = (map->centre(static_cast<CellIndex>(i)) - *map->reel).norm();
    out.within_length.at_most += limits.allowsLength(distance) ? 1U : 0U;
    out.within_length.reached += ways.shown(i, Ways::kLength) ? 1U : 0U;
    out.within_elevation += ways.shown(i, Ways::kElevation) ? 1U : 0U;
    out.within_limits.reached += ways.shown(i, Ways::kBoth) ? 1U : 0U;
  }
  out.within_limits.at_most = out.within_length.at_most;
  out.with_at_most = countContacts(*map, ways, out.contacts, limits.contacts_max, progress);
  out.complete = ways.complete() && !progress.cancelled();
  return out;
}

}  // namespace tautline::planning
