#pragma once

/// @file
/// Small maps, fields and strings made by hand for the tests of this folder.

#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/field/map_fields.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {

/// A string that has a contact at each of the given points whose x the vehicle is beyond, in order
/// of x: stack = number of contacts.
class PolesString : public TautString {
 public:
  PolesString(const Eigen::Vector3d& reel, std::vector<Eigen::Vector3d> poles)
      : reel_(reel), poles_(std::move(poles)) {}

  const Eigen::Vector3d& reel() const noexcept override { return reel_; }
  StackId move(StackId /*stack*/, const Eigen::Vector3d& /*from*/,
               const Eigen::Vector3d& to) override {
    StackId count = 0;
    while (count < poles_.size() && to.x() > poles_[count].x()) ++count;
    return count;
  }
  Eigen::Vector3d anchor(StackId stack) const override {
    return stack == 0 ? reel_ : poles_[stack - 1];
  }
  double staticLength(StackId stack) const override {
    double length = 0.0;
    for (StackId i = 0; i < stack; ++i) length += (poles_[i] - anchor(i)).norm();
    return length;
  }
  int contactCount(StackId stack) const override { return static_cast<int>(stack); }
  std::vector<Eigen::Vector3d> contacts(StackId stack) const override {
    return {poles_.begin(), poles_.begin() + stack};
  }
  bool touchesForbidden(StackId stack) const override { return stack > allowed_; }

  /// Stacks of more contacts touch what they must not.
  void forbidBeyond(StackId count) { allowed_ = count; }

 private:
  Eigen::Vector3d reel_;
  std::vector<Eigen::Vector3d> poles_;
  StackId allowed_{std::numeric_limits<StackId>::max()};
};

/// All cells free.
inline VoxelMap emptyMap(GridShape shape, double resolution) {
  VoxelMap map;
  map.name = map.file = "test";
  map.shape = shape;
  map.resolution = resolution;
  map.cells.assign(shape.size(), CellState::kFree);
  return map;
}

/// Fields of one value everywhere [m].
inline MapFields evenFields(const VoxelMap& map, float distance, float width, float visibility) {
  MapFields fields;
  fields.distance.assign(map.shape.size(), distance);
  fields.width.assign(map.shape.size(), width);
  fields.visibility.assign(map.shape.size(), visibility);
  return fields;
}

/// Parameters of a risk that is zero: tests turn on what they are about.
inline RiskParams nothingOn() {
  RiskParams params;
  params.distance.member.risk = 0.0;
  params.visibility.member.risk = 0.0;
  params.action_length.per_metre = 0.0;
  params.turn.risk = 0.0;
  params.tether_length.per_metre = 0.0;
  params.contacts.each = 0.0;
  return params;
}

inline RiskModel modelOf(VoxelMap map, MapFields fields, const RiskParams& params,
                         std::shared_ptr<TautString> string = nullptr) {
  return {std::make_shared<const VoxelMap>(std::move(map)), std::move(fields), params,
          std::move(string)};
}

/// A random walk on the lattice from a random free cell that has a neighbour; at most `steps`
/// steps.
inline std::vector<CellIndex> randomWalk(const Lattice& lattice, int steps, std::mt19937& random) {
  std::uniform_int_distribution<CellIndex> any(0,
                                               static_cast<CellIndex>(lattice.shape().size()) - 1);
  CellIndex cell = any(random);
  while (lattice.moves(cell) == 0) cell = any(random);
  std::vector<CellIndex> path{cell};
  for (int i = 0; i < steps; ++i) {
    Direction d = std::uniform_int_distribution<Direction>(0, kDirections - 1)(random);
    while ((lattice.moves(path.back()) >> d & 1U) == 0) d = (d + 1) % kDirections;
    path.push_back(lattice.neighbour(path.back(), d));
  }
  return path;
}

}  // namespace tautline::planning
