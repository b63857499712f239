#include "app/experiments/reachable_space.h"

#include <limits>
#include <memory>

#include "common/error.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/reach.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/picture/plan_picture.h"
#include "planning_offline/planner/tether_reach.h"

namespace tautline::experiments {
namespace {

using planning::VoxelMap;

constexpr double kStraightShare = 60.0;  // published [%]
constexpr double kContactShare = 100.0;  // published [%]
constexpr const char* kTrial = "shaft";

VoxelMap shaftRoom(const Setup& setup) {
  return planning::loadMap(setup.folder / "../scenes/dissertation/shaft.scene.toml", {});
}

/// Cells of a layer half way up, seen from above.
int drawnLayer(const VoxelMap& map) { return map.shape.ny / 2; }

nlohmann::json countCells(const Setup& setup) {
  const auto map = std::make_shared<const VoxelMap>(shaftRoom(setup));
  const planning::Progress progress;
  // As published: the whole free space counts, and the tether keeps one voxel away from the shaft.
  const planning::Lattice lattice(map->shape, planning::Connectivity::kVertices,
                                  planning::freeSpace(*map, {}, progress));
  const planning::ReachOptions inflated{.tether_clearance = map->resolution};
  const planning::ReachMap published =
      planning::computeReach(*map, lattice.freeCells(), *map->reel, inflated, progress);
  const planning::ReachMap bare =
      planning::computeReach(*map, lattice.freeCells(), *map->reel, {}, progress);
  const planning::TetherReach string = planning::tetherReach(
      map, lattice, published, planning::TetherLimits{.contacts_max = 1}, progress);
  TAUTLINE_CHECK(string.complete && string.with_at_most.size() == 2);
  nlohmann::json layer = nlohmann::json::array();
  for (std::size_t i = 0; i < map->shape.size(); ++i) {
    const auto cell = static_cast<planning::CellIndex>(i);
    if (map->shape.cell(cell).y() != drawnLayer(*map)) continue;
    layer.push_back({i, published.straight[i] != 0 ? 0 : string.contacts[i]});
  }
  return {{"free", published.free},
          {"straight", published.straight_count},
          {"straight_bare", bare.straight_count},
          {"connected", published.with_contacts_count},
          {"one_contact", string.with_at_most[1].reached},
          {"layer", layer}};
}

std::vector<Trial> trials(const Setup& setup) {
  return {{kTrial, [&setup] { return countCells(setup); }}};
}

Findings judge(const Setup& setup, const Results& results) {
  const nlohmann::json& r = results.at(kTrial);
  const auto share = [&r](const char* key) {
    return 100.0 * r.at(key).get<double>() / r.at("free").get<double>();
  };
  Findings findings;
  findings.rows = {
      {.figure = "reached by a straight tether (ray casting)",
       .unit = "%",
       .published = kStraightShare,
       .as_published = share("straight"),
       .as_published_band = Band{59.5, 60.5},
       .note = "590 of 990 voxels; published as a whole number"},
      {.figure = "reached with contacts",
       .unit = "%",
       .published = kContactShare,
       .as_published = share("connected"),
       .tautline = share("one_contact"),
       .as_published_band = Band{kContactShare, kContactShare},
       .tautline_band = Band{kContactShare, kContactShare},
       .note = "ours: a way to fly there exists on which the taut string touches once at most"},
      {.figure = "reached by a straight tether, no inflation",
       .unit = "%",
       .tautline = share("straight_bare"),
       .note = "ours plans the tether against the shaft itself"},
  };
  const VoxelMap map = shaftRoom(setup);
  std::vector<double> shown(map.shape.size(), std::numeric_limits<double>::infinity());
  for (const nlohmann::json& cell : r.at("layer")) {
    const int contacts = cell.at(1);
    if (contacts >= 0) shown[cell.at(0).get<std::size_t>()] = contacts;
  }
  findings.pictures.push_back(
      {"layer", "Half way up: 0 straight past the inflated shaft, 1 with a contact",
       planning::fieldFigure("Reach of the tether", "contacts", map, shown, drawnLayer(map))});
  return findings;
}

}  // namespace

const Experiment kReachableSpace{
    "reachable_space", "Reachable space",
    "A room of 10 × 10 × 10 voxels with a shaft of one voxel from floor to ceiling, the reel in a "
    "corner: voxels that a straight tether reaches past the shaft inflated by one voxel, and those "
    "that are reached when it may touch the shaft.",
    trials, judge};

}  // namespace tautline::experiments
