#pragma once

/// @file
/// Small random maps with every kind of risk, and an oracle for them: the risk of a path written
/// down from its definition (docs/risk.md), and searches that try everything. It shares no code
/// with the risk model, the lattice or the planners; only the tether's length and contacts come
/// from the taut string.

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning::testing {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  [[nodiscard]] double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_()) / 4294967296.0;
  }
  [[nodiscard]] int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

 private:
  std::mt19937 engine_;
};

struct SmallWorld {
  std::shared_ptr<VoxelMap> map;
  MapFields fields;
  RiskParams params;
  bool tethered{false};
  Connectivity connectivity{Connectivity::kFaces};
  CellIndex start{0};
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> risk;

  /// Makes lattice and risk from the rest.
  void build();
  [[nodiscard]] bool isFree(CellIndex i) const {
    return map->cells[static_cast<std::size_t>(i)] == CellState::kFree;
  }
};

/// A map of free cells of 1 m without layers; all elements but action length off.
[[nodiscard]] SmallWorld emptyWorld(GridShape shape, Connectivity connectivity);

struct WorldKind {
  Connectivity connectivity{Connectivity::kFaces};
  bool planar{true};
  TurnLaw law{TurnLaw::kLinear};
  RiskMode mode{RiskMode::kPerState};
  bool tether{false};
  bool mud{false};
  bool battery{false};
  int side{0};        ///< Cells along an edge; 0: as many as all simple paths can be tried on.
  bool sharp{false};  ///< Half of the obstacles must not be touched by the tether.
};
/// Random obstacles, locale risks, access characters, mud, start and parameters.
[[nodiscard]] SmallWorld randomWorld(const WorldKind& kind, std::uint32_t seed);

/// Risk by definition.
class Oracle {
 public:
  explicit Oracle(const SmallWorld& world);

  /// What the definition needs to know of a path to go on with it.
  struct Tail {
    CellIndex cell{kNoCell};
    CellIndex before{kNoCell};
    double cost{0.0};
    double mud{0.0};
    double way{0.0};  ///< Of the battery: metres and climbed metres.
    StackId stack{kStraight};
  };
  [[nodiscard]] Tail start();
  [[nodiscard]] Tail step(const Tail& tail, CellIndex next);
  [[nodiscard]] double costOf(const std::vector<CellIndex>& path);
  [[nodiscard]] const std::vector<CellIndex>& neighbours(CellIndex cell) const {
    return neighbours_[static_cast<std::size_t>(cell)];
  }

  /// Least cost of all simple paths to each cell. False if there are more than `paths_max`.
  [[nodiscard]] bool simpleOptima(std::int64_t paths_max, std::vector<double>& best);
  /// Least cost of all walks of at most `steps` steps, started from the simple paths' optima.
  [[nodiscard]] std::vector<double> walkOptima(int steps, const std::vector<double>& simple);
  /// Least cost of all walks, without traverse elements: Bellman and Ford's iteration over pairs of
  /// consecutive cells.
  [[nodiscard]] std::vector<double> walkOptimaByIteration();

 private:
  [[nodiscard]] double localeCost(CellIndex cell) const;
  [[nodiscard]] double turnCost(CellIndex a, CellIndex b, CellIndex c) const;
  [[nodiscard]] double tetherCost(const Tail& tail) const;
  [[nodiscard]] double traverseCost(const Tail& tail) const;
  [[nodiscard]] double weight(double metres) const;
  void simpleFrom(const Tail& tail, std::int64_t& left, std::vector<double>& best);
  void walksFrom(const Tail& tail, int steps, std::vector<double>& best);

  const SmallWorld& world_;
  std::unique_ptr<TautString> string_;
  std::vector<std::vector<CellIndex>> neighbours_;
  std::vector<char> visited_;
};

}  // namespace tautline::planning::testing
