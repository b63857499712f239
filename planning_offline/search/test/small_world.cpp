#include "planning_offline/search/test/small_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planning_offline/tether/taut_string.h"

namespace tautline::planning::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(CellIndex i) { return static_cast<std::size_t>(i); }

const std::vector<double>* layerOf(const VoxelMap& map, const char* name) {
  for (const MapLayer& layer : map.layers) {
    if (layer.name == name) return &layer.values;
  }
  return nullptr;
}

double layerAt(const VoxelMap& map, const char* name, CellIndex i) {
  const std::vector<double>* values = layerOf(map, name);
  return values == nullptr ? 0.0 : (*values)[at(i)];
}

/// A contact touches a marked cell if it is no farther than half an edge from its centre.
bool touchesSharp(const VoxelMap& map, const Eigen::Vector3d& contact) {
  for (std::size_t i = 0; i < map.no_contact.size(); ++i) {
    const Eigen::Vector3d away = contact - map.centre(static_cast<CellIndex>(i));
    if (map.no_contact[i] != 0 && away.cwiseAbs().maxCoeff() < 0.50001 * map.resolution)
      return true;
  }
  return false;
}

}  // namespace

void SmallWorld::build() {
  std::vector<std::uint8_t> free;
  for (const CellState state : map->cells) free.push_back(state == CellState::kFree ? 1 : 0);
  lattice = std::make_unique<Lattice>(map->shape, connectivity, free);
  std::shared_ptr<TautString> string;
  if (tethered) string = makeTautString(*map, map->reel.value_or(map->centre(start)));
  risk = std::make_unique<RiskModel>(map, fields, params, string);
}

SmallWorld emptyWorld(GridShape shape, Connectivity connectivity) {
  SmallWorld world;
  world.connectivity = connectivity;
  world.map = std::make_shared<VoxelMap>();
  world.map->shape = shape;
  world.map->cells.assign(shape.size(), CellState::kFree);
  world.params.distance.member.risk = 0.0;
  world.params.visibility.member.risk = 0.0;
  world.params.turn.risk = 0.0;
  world.params.tether_length.per_metre = 0.0;
  world.params.contacts.each = 0.0;
  return world;
}

SmallWorld randomWorld(const WorldKind& kind, std::uint32_t seed) {
  Random random(seed);
  const bool sparse = kind.connectivity == Connectivity::kFaces;
  GridShape shape = kind.planar
                        ? GridShape{3 + random.below(2), 1, 3 + random.below(sparse ? 2 : 1)}
                        : GridShape{2 + random.below(2), 2, 3};
  if (kind.side > 0) shape = {kind.side, kind.planar ? 1 : kind.side, kind.side};
  SmallWorld world = emptyWorld(shape, kind.connectivity);
  VoxelMap& map = *world.map;
  map.resolution = kind.mode == RiskMode::kRate ? random.uniform(0.2, 1.0) : 1.0;
  map.origin = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  const double blocked = kind.planar ? (sparse ? 0.2 : 0.3) : (sparse ? 0.25 : 0.45);
  for (CellState& state : map.cells) {
    if (random.uniform(0.0, 1.0) < blocked) state = CellState::kOccupied;
  }
  world.start = static_cast<CellIndex>(random.below(static_cast<int>(shape.size())));
  map.cells[at(world.start)] = CellState::kFree;

  const auto layer = [&](const char* name, double zero_chance, double most) {
    MapLayer made{name, {}};
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const bool zero = random.uniform(0.0, 1.0) < zero_chance;
      made.values.push_back(zero ? 0.0 : random.uniform(0.0, most));
    }
    map.layers.push_back(std::move(made));
  };
  layer("terrain_stability", 0.3, 1.0);
  layer("surface", 0.0, 1.0);
  if (random.below(4) == 0) {  // certain failure somewhere, but not at the start
    map.layers.back()
        .values[at(static_cast<CellIndex>(random.below(static_cast<int>(shape.size()))))] = 1.0;
    map.layers.back().values[at(world.start)] = 0.5;
  }
  if (kind.mud) layer("slippage", 0.6, 1.0);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    world.fields.width.push_back(static_cast<float>(random.uniform(0.5, 3.0)));
  }

  RiskParams& p = world.params;
  p.mode = kind.mode;
  p.reference_step = 0.4;
  p.terrain_stability.scale = random.uniform(0.0, 0.2);
  p.surface.scale = random.below(2) == 0 ? 1.0 : 0.1;
  if (p.surface.scale == 1.0) {
    for (double& value : map.layers[1].values) {
      if (value < 1.0) value *= 0.1;
    }
  }
  p.action_length.per_metre = random.uniform(0.0, 0.1);
  p.turn = {.law = kind.law, .risk = random.uniform(0.0, 0.15)};
  p.access.per_unit = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 0.1);
  if (kind.tether) {
    world.tethered = true;
    p.tether_length.per_metre = random.uniform(0.0, 0.03);
    p.contacts.each = random.uniform(0.01, 0.2);
    if (random.below(3) == 0)
      p.tether_limits.length_max = map.resolution * random.uniform(2.0, 6.0);
    if (random.below(4) == 0) p.tether_limits.contacts_max = 1;
    if (!kind.planar && random.below(3) == 0) p.tether_limits.elevation_min = -30.0;
  }
  if (kind.mud) p.slippage.per_mud = random.uniform(0.1, 1.0);
  if (kind.battery) {
    p.battery = {.member = {random.uniform(0.1, 0.8), 1.0, 0.0},
                 .range = map.resolution * random.uniform(5.0, 12.0),
                 .climb_factor = random.uniform(0.0, 4.0)};
  }
  for (std::size_t i = 0; kind.sharp && i < shape.size(); ++i) {
    const bool sharp = random.below(2) == 0 && map.cells[i] == CellState::kOccupied;
    map.no_contact.push_back(sharp ? 1 : 0);
  }
  world.build();
  return world;
}

Oracle::Oracle(const SmallWorld& world)
    : world_(world), neighbours_(world.map->shape.size()), visited_(world.map->shape.size(), 0) {
  const VoxelMap& map = *world.map;
  if (world.tethered) string_ = makeTautString(map, map.reel.value_or(map.centre(world.start)));
  const auto cells = static_cast<CellIndex>(map.shape.size());
  const int axes_max = 1 + static_cast<int>(world.connectivity);
  for (CellIndex a = 0; a < cells; ++a) {
    for (CellIndex b = 0; b < cells; ++b) {
      const Eigen::Vector3i pa = map.shape.cell(a);
      const Eigen::Vector3i pb = map.shape.cell(b);
      const Eigen::Vector3i step = pb - pa;
      if (a == b || step.cwiseAbs().maxCoeff() > 1 || step.cwiseAbs().sum() > axes_max) continue;
      // No corner is cut: every cell between the two in each coordinate is free.
      bool allowed = true;
      for (CellIndex c = 0; c < cells; ++c) {
        const Eigen::Vector3i pc = map.shape.cell(c);
        const bool between = (pc.array() >= pa.cwiseMin(pb).array()).all() &&
                             (pc.array() <= pa.cwiseMax(pb).array()).all();
        if (between && !world.isFree(c)) allowed = false;
      }
      if (allowed) neighbours_[at(a)].push_back(b);
    }
  }
}

double Oracle::weight(double metres) const {
  return world_.params.mode == RiskMode::kRate ? metres / world_.params.reference_step : 1.0;
}

double Oracle::localeCost(CellIndex cell) const {
  const RiskParams& p = world_.params;
  double cost = 0.0;
  for (const auto& [name, scale] : {std::pair{"terrain_stability", p.terrain_stability.scale},
                                    std::pair{"surface", p.surface.scale}}) {
    const double r = scale * layerAt(*world_.map, name, cell);
    cost += -std::log(1.0 - (r < 1.0 ? std::min(r, p.cap) : 1.0));
  }
  return cost;
}

double Oracle::turnCost(CellIndex a, CellIndex b, CellIndex c) const {
  const RiskParams& p = world_.params;
  Eigen::Vector3d first = world_.map->centre(b) - world_.map->centre(a);
  Eigen::Vector3d second = world_.map->centre(c) - world_.map->centre(b);
  const double cosine = first.dot(second) / (first.norm() * second.norm());
  if (p.mode == RiskMode::kRate) {
    first /= first.norm();
    second /= second.norm();
  }
  const double change = (second - first).norm();
  double r = 0.0;
  if (p.turn.law == TurnLaw::kConstant) r = cosine < 1.0 - 1e-9 ? p.turn.risk : 0.0;
  if (p.turn.law == TurnLaw::kLinear) r = p.turn.risk * change;
  if (p.turn.law == TurnLaw::kQuadratic) r = p.turn.risk * change * change;
  if (p.turn.law == TurnLaw::kThreshold) {
    r = p.turn.risk * change * (cosine > p.turn.gentle_cosine ? 1.0 : p.turn.sharp_factor);
  }
  return -std::log(1.0 - std::min(r, p.cap));
}

double Oracle::tetherCost(const Tail& tail) const {
  if (string_ == nullptr) return 0.0;
  const RiskParams& p = world_.params;
  const Eigen::Vector3d here = world_.map->centre(tail.cell);
  const double length = string_->length(tail.stack, here);
  const Eigen::Vector3d last = here - string_->anchor(tail.stack);
  if (last.norm() > 0.0 && std::asin(last.y() / last.norm()) * 180.0 / 3.14159265358979323846 <
                               p.tether_limits.elevation_min) {
    return kInfinity;
  }
  const TetherLimits& limits = p.tether_limits;
  const int n = string_->contactCount(tail.stack);
  if (limits.length_max > 0.0 && length > limits.length_max + 1e-9) return kInfinity;
  if (limits.contacts_max >= 0 && n > limits.contacts_max) return kInfinity;
  for (const Eigen::Vector3d& contact : string_->contacts(tail.stack)) {
    if (touchesSharp(*world_.map, contact)) return kInfinity;
  }
  return -std::log(1.0 - std::min(p.cap, p.tether_length.per_metre * length)) -
         std::log(1.0 - std::min(p.cap, p.contacts.each * n));
}

double Oracle::traverseCost(const Tail& tail) const {
  const RiskParams& p = world_.params;
  const double slip = p.slippage.per_mud * tail.mud * layerAt(*world_.map, "slippage", tail.cell);
  const Membership& m = p.battery.member;
  const double used = (tail.way / p.battery.range - m.none) / (m.full - m.none);
  const double drained = m.risk * std::clamp(used, 0.0, 1.0);
  return tetherCost(tail) - std::log(1.0 - std::min(p.cap, slip)) -
         std::log(1.0 - (drained < 1.0 ? std::min(p.cap, drained) : 1.0));
}

Oracle::Tail Oracle::start() {
  Tail tail{.cell = world_.start};
  if (string_) {
    tail.stack = string_->move(kStraight, string_->reel(), world_.map->centre(tail.cell));
  }
  const bool rate = world_.params.mode == RiskMode::kRate;
  tail.cost = rate ? 0.0 : localeCost(tail.cell);
  const double traverse = traverseCost(tail);
  if (!rate || std::isinf(traverse)) tail.cost += traverse;
  if (std::isinf(localeCost(tail.cell))) tail.cost = kInfinity;
  return tail;
}

Oracle::Tail Oracle::step(const Tail& tail, CellIndex next) {
  const RiskParams& p = world_.params;
  const VoxelMap& map = *world_.map;
  const bool rate = p.mode == RiskMode::kRate;
  const Eigen::Vector3d action = map.centre(next) - map.centre(tail.cell);
  const double metres = action.norm();
  Tail to = tail;
  to.before = tail.cell;
  to.cell = next;

  const double way = rate ? p.reference_step : metres;
  to.cost -= weight(metres) * std::log(1.0 - std::min(p.cap, p.action_length.per_metre * way));
  if (tail.before != kNoCell) to.cost += turnCost(tail.before, tail.cell, next);
  const double lost =
      static_cast<double>(world_.fields.width.empty() ? 0.0F : world_.fields.width[at(tail.cell)]) -
      static_cast<double>(world_.fields.width.empty() ? 0.0F : world_.fields.width[at(next)]);
  const double access = p.access.per_unit * std::max(0.0, lost);
  to.cost +=
      rate ? std::min(access, -std::log(1.0 - p.cap)) : -std::log(1.0 - std::min(p.cap, access));

  const double slippery_here = layerAt(map, "slippage", tail.cell);
  const double slippery_there = layerAt(map, "slippage", next);
  to.mud += rate ? weight(metres) * (slippery_here + slippery_there) / 2.0 : slippery_here;
  to.way += metres + p.battery.climb_factor * std::max(0.0, action.y());
  if (string_) to.stack = string_->move(tail.stack, map.centre(tail.cell), map.centre(next));
  const double before = localeCost(tail.cell) + traverseCost(tail);
  const double after = localeCost(next) + traverseCost(to);
  to.cost += rate ? weight(metres) * (before + after) / 2.0 : after;
  return to;
}

double Oracle::costOf(const std::vector<CellIndex>& path) {
  Tail tail = start();
  if (path.empty() || path.front() != tail.cell) return kInfinity;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const std::vector<CellIndex>& next = neighbours(tail.cell);
    if (std::find(next.begin(), next.end(), path[i]) == next.end()) return kInfinity;
    tail = step(tail, path[i]);
  }
  return tail.cost;
}

bool Oracle::simpleOptima(std::int64_t paths_max, std::vector<double>& best) {
  best.assign(world_.map->shape.size(), kInfinity);
  std::fill(visited_.begin(), visited_.end(), 0);
  simpleFrom(start(), paths_max, best);
  return paths_max > 0;
}

void Oracle::simpleFrom(const Tail& tail, std::int64_t& left, std::vector<double>& best) {
  if (!(tail.cost < kInfinity) || --left <= 0) return;
  best[at(tail.cell)] = std::min(best[at(tail.cell)], tail.cost);
  visited_[at(tail.cell)] = 1;
  for (const CellIndex next : neighbours(tail.cell)) {
    if (visited_[at(next)] == 0) simpleFrom(step(tail, next), left, best);
  }
  visited_[at(tail.cell)] = 0;
}

std::vector<double> Oracle::walkOptima(int steps, const std::vector<double>& simple) {
  std::vector<double> best = simple;
  walksFrom(start(), steps, best);
  return best;
}

void Oracle::walksFrom(const Tail& tail, int steps, std::vector<double>& best) {
  // Costs only grow: a walk above every optimum cannot lower any of them.
  double most = 0.0;
  for (const double cost : best) {
    if (cost < kInfinity) most = std::max(most, cost);
  }
  if (!(tail.cost < most)) return;
  best[at(tail.cell)] = std::min(best[at(tail.cell)], tail.cost);
  if (steps == 0) return;
  for (const CellIndex next : neighbours(tail.cell)) walksFrom(step(tail, next), steps - 1, best);
}

std::vector<double> Oracle::walkOptimaByIteration() {
  struct Pair {
    CellIndex before, cell;
    double cost;
  };
  std::vector<Pair> pairs{{kNoCell, world_.start, start().cost}};
  for (std::size_t a = 0; a < neighbours_.size(); ++a) {
    for (const CellIndex b : neighbours_[a]) {
      pairs.push_back({static_cast<CellIndex>(a), b, kInfinity});
    }
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const Pair& from : pairs) {
      if (!(from.cost < kInfinity)) continue;
      for (Pair& to : pairs) {
        if (to.before != from.cell) continue;
        const Tail tail{.cell = from.cell, .before = from.before, .cost = from.cost};
        const double cost = step(tail, to.cell).cost;
        if (cost < to.cost - 1e-15) {
          to.cost = cost;
          changed = true;
        }
      }
    }
  }
  std::vector<double> best(neighbours_.size(), kInfinity);
  for (const Pair& pair : pairs) best[at(pair.cell)] = std::min(best[at(pair.cell)], pair.cost);
  return best;
}

}  // namespace tautline::planning::testing
