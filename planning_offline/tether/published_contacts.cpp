#include "planning_offline/tether/published_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "common/error.h"
#include "common/fields.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reel_place.h"
#include "planning_offline/tether/convex_edges.h"

namespace tautline::planning {
namespace {

constexpr Range kStepRange{0.001, 1.0};    // [cells]
constexpr Range kStandoffRange{0.0, 0.5};  // [cells]

/// What the algorithm asks the map about lines, and its answer to where a contact goes. In cells.
class Obstacles {
 public:
  Obstacles(const VoxelMap& map, const PublishedOptions& options)
      : map_(map),
        options_(options),
        blocked_(obstacleCells(map, false)),
        edges_{ConvexEdges(map, 0), ConvexEdges(map, 1), ConvexEdges(map, 2)} {}

  /// CheckCollision(): the first point of the sampled line from a to b inside an obstacle.
  [[nodiscard]] std::optional<Eigen::Vector3d> collision(const Eigen::Vector3d& a,
                                                         const Eigen::Vector3d& b) const;

  /// The contact for a line from anchor to waypoint that collides first at `hit`.
  [[nodiscard]] Eigen::Vector3d contact(const Eigen::Vector3d& anchor, const Eigen::Vector3d& hit,
                                        const Eigen::Vector3d& waypoint) const;

  /// Exactly, not sampled.
  [[nodiscard]] bool sees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return lineOfSight(map_.shape, blocked_, a, b);
  }
  /// Whether the line from a to b goes through the inside of an obstacle, exactly.
  [[nodiscard]] bool pierced(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return !outsideSolids(map_.shape, blocked_, a, b);
  }

 private:
  /// A line that is to be bent round an obstacle.
  struct Bend {
    Eigen::Vector3d anchor;
    Eigen::Vector3d hit;
    Eigen::Vector3d waypoint;
  };
  struct Choice {
    bool seen{false};  ///< From anchor and waypoint, where that is asked for.
    double cost{std::numeric_limits<double>::infinity()};
    Eigen::Vector3d point;
    [[nodiscard]] bool betterThan(const Choice& other) const {
      return seen != other.seen ? seen : cost < other.cost;
    }
  };

  /// Calls visit(p) for each point of the sampled line until it returns false.
  template <class Visit>
  void sample(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Visit visit) const;
  /// Considers the convex edges of one occupied cell.
  void consider(const Eigen::Vector3i& cell, const Bend& bend, std::optional<Choice>& best) const;
  [[nodiscard]] Choice choice(const ConvexEdge& edge, int slab, const Bend& bend) const;

  const VoxelMap& map_;
  const PublishedOptions& options_;
  std::vector<std::uint8_t> blocked_;
  std::array<ConvexEdges, 3> edges_;
};

template <class Visit>
void Obstacles::sample(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Visit visit) const {
  const double length = (b - a).norm();
  for (int i = 0; i * options_.sample_step < length; ++i) {
    if (!visit(Eigen::Vector3d(a + (b - a) * (i * options_.sample_step / length)))) return;
  }
  (void)visit(b);
}

std::optional<Eigen::Vector3d> Obstacles::collision(const Eigen::Vector3d& a,
                                                    const Eigen::Vector3d& b) const {
  std::optional<Eigen::Vector3d> hit;
  sample(a, b, [&](const Eigen::Vector3d& p) {
    if (insideObstacle(map_, p)) hit = p;
    return !hit;
  });
  return hit;
}

/// The place on an edge where the way from a to b over it is shortest: the way is straight when the
/// planes through a and b and the edge are folded into one.
double shortestOver(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const ConvexEdge& edge) {
  const Eigen::Vector2d corner(edge.u, edge.v);
  const auto away = [&](const Eigen::Vector3d& p) {
    return (across(edge.axis, p) - corner).norm();
  };
  const double sum = away(a) + away(b);
  const double part = sum > 0.0 ? away(a) / sum : 0.5;
  return a[edge.axis] + part * (b[edge.axis] - a[edge.axis]);
}

Obstacles::Choice Obstacles::choice(const ConvexEdge& edge, int slab, const Bend& bend) const {
  const bool nearest = options_.placement == ContactPlacement::kNearestEdge;
  const double place =
      nearest ? bend.hit[edge.axis] : shortestOver(bend.anchor, bend.waypoint, edge);
  Choice choice;
  choice.point[edge.axis] = std::clamp(place, slab + 0.0, slab + 1.0);
  choice.point[axisU(edge.axis)] = edge.u;
  choice.point[axisV(edge.axis)] = edge.v;
  if (nearest) choice.cost = (choice.point - bend.hit).norm();
  choice.point[axisU(edge.axis)] -= options_.standoff * edge.sideU();
  choice.point[axisV(edge.axis)] -= options_.standoff * edge.sideV();
  if (!nearest) {
    choice.cost = (choice.point - bend.anchor).norm() + (bend.waypoint - choice.point).norm();
    choice.seen = sees(bend.anchor, choice.point) && sees(choice.point, bend.waypoint);
  }
  return choice;
}

void Obstacles::consider(const Eigen::Vector3i& cell, const Bend& bend,
                         std::optional<Choice>& best) const {
  for (const ConvexEdges& convex : edges_) {
    const int axis = convex.axis();
    // In the plane only upright edges bend the tether.
    if (map_.shape.planar() && axis != 1) continue;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      // A cell in an edge's upper quadrant has the edge on its lower side.
      const ConvexEdge edge{axis, cell[axisU(axis)] + ((quadrant & 1) != 0 ? 0 : 1),
                            cell[axisV(axis)] + ((quadrant & 2) != 0 ? 0 : 1), quadrant};
      if ((convex.quadrants(edge.u, edge.v, cell[axis]) >> quadrant & 1U) == 0) continue;
      const Choice candidate = choice(edge, cell[axis], bend);
      if (!best || candidate.betterThan(*best)) best = candidate;
    }
  }
}

Eigen::Vector3d Obstacles::contact(const Eigen::Vector3d& anchor, const Eigen::Vector3d& hit,
                                   const Eigen::Vector3d& waypoint) const {
  if (options_.placement == ContactPlacement::kEntry) return hit;
  const Bend bend{anchor, hit, waypoint};
  std::optional<Choice> best;
  std::optional<Eigen::Vector3i> last;
  sample(anchor, waypoint, [&](const Eigen::Vector3d& p) {
    if (!insideObstacle(map_, p)) return true;
    const Eigen::Vector3i cell = p.array().floor().cast<int>();
    if (cell != last) consider(cell, bend, best);
    last = cell;
    return true;
  });
  if (best) return best->point;
  // The line cuts the obstacle in cells without an edge: through the faces of a wall.
  for (CellIndex i = 0; i < static_cast<CellIndex>(blocked_.size()); ++i) {
    if (blocked_[static_cast<std::size_t>(i)] != 0) consider(map_.shape.cell(i), bend, best);
  }
  TAUTLINE_CHECK(best.has_value());  // any finite obstacle has convex edges
  return best->point;
}

/// Throws InputError unless the option is in range.
void needRange(const char* key, double value, const Range& range) {
  if (range.contains(value)) return;
  throw InputError(
      {.key = key,
       .problem = "is " + std::to_string(value),
       .allowed = std::to_string(range.min) + " to " + std::to_string(range.max) + " cells"});
}

Eigen::Vector3d metres(const VoxelMap& map, const Eigen::Vector3d& p_cells) {
  return map.origin + map.resolution * p_cells;
}

/// A point in M in cells; in a planar map in the middle of the plane.
Eigen::Vector3d cellsOf(const VoxelMap& map, const Eigen::Vector3d& p_M, const std::string& key) {
  Eigen::Vector3d p = (p_M - map.origin) / map.resolution;
  if (map.shape.planar()) p.y() = 0.5;
  if ((p.array().abs() <= kSightFarthest).all()) return p;  // NaN fails
  throw InputError(
      {.file = map.file, .key = key, .problem = "is too far from the map or not a number"});
}

/// `stack`: from the reel to the last contact.
bool pierces(const Obstacles& obstacles, const std::vector<Eigen::Vector3d>& stack,
             const Eigen::Vector3d& waypoint) {
  for (std::size_t i = 0; i < stack.size(); ++i) {
    if (obstacles.pierced(stack[i], i + 1 < stack.size() ? stack[i + 1] : waypoint)) return true;
  }
  return false;
}

}  // namespace

std::vector<PublishedState> publishedContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                              std::span<const Eigen::Vector3d> path,
                                              const PublishedOptions& options) {
  needRange("sample_step", options.sample_step, kStepRange);
  needRange("standoff", options.standoff, kStandoffRange);
  const Obstacles obstacles(map, options);
  std::vector<Eigen::Vector3d> cp_stack{cellsOf(map, reel, "reel")};
  (void)checkedReel(map, metres(map, cp_stack.front()));
  std::vector<PublishedState> states;
  states.reserve(path.size());
  for (const Eigen::Vector3d& waypoint : path) {
    const Eigen::Vector3d wp =
        cellsOf(map, waypoint, "path[" + std::to_string(states.size()) + "]");
    std::vector<Eigen::Vector3d> attached = cp_stack;
    PublishedState state;
    const Eigen::Vector3d current_contact = cp_stack.back();
    bool relax = false;
    if (cp_stack.size() > 1) {
      const Eigen::Vector3d last_contact = cp_stack[cp_stack.size() - 2];
      const bool line_free = !obstacles.collision(last_contact, wp);
      state.relaxation_refused = line_free && obstacleConfined(map, current_contact, last_contact,
                                                               wp, options.confinement);
      relax = line_free && !state.relaxation_refused;
    }
    if (relax) {
      cp_stack.pop_back();
    } else if (const auto hit = obstacles.collision(current_contact, wp)) {
      cp_stack.push_back(obstacles.contact(current_contact, *hit, wp));
    }
    if (options.attachment == Attachment::kThisWaypoint) attached = cp_stack;
    state.pierces = pierces(obstacles, attached, wp);
    for (std::size_t i = 1; i < attached.size(); ++i)
      state.contacts.push_back(metres(map, attached[i]));
    states.push_back(std::move(state));
  }
  return states;
}

}  // namespace tautline::planning
