#include "planning_offline/tether/hanging_contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/catenary.h"
#include "planning_offline/tether/contact_plan.h"

namespace tautline::planning {
namespace {

double levelDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::hypot(b.x() - a.x(), b.z() - a.z());
}

/// Heights between which there is an upright convex edge through a point.
struct EdgeSpan {
  double low;
  double high;
};

/// The cells round an upright line at one height: one of them solid, or two across from each other,
/// is a convex edge.
class UprightEdges {
 public:
  explicit UprightEdges(const VoxelMap& map) : map_(map) {}

  [[nodiscard]] std::optional<EdgeSpan> spanAt(const Eigen::Vector3d& p) const {
    constexpr double kOnGrid = 1e-2;  // [cells]
    const Eigen::Vector3d c = (p - map_.origin) / map_.resolution;
    const int u = static_cast<int>(std::round(c.x()));
    const int v = static_cast<int>(std::round(c.z()));
    if (std::abs(c.x() - u) > kOnGrid || std::abs(c.z() - v) > kOnGrid) return std::nullopt;
    const int layer =
        std::clamp(static_cast<int>(std::floor(c.y())), 0, std::max(0, map_.shape.ny - 1));
    const unsigned here = around(u, layer, v);
    if (!isConvex(here)) return std::nullopt;
    int low = layer;
    int high = layer;
    while (low > 0 && around(u, low - 1, v) == here) --low;
    while (high + 1 < map_.shape.ny && around(u, high + 1, v) == here) ++high;
    return EdgeSpan{map_.origin.y() + low * map_.resolution,
                    map_.origin.y() + (high + 1) * map_.resolution};
  }

 private:
  [[nodiscard]] unsigned around(int u, int layer, int v) const {
    unsigned mask = 0;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3i cell(u - 1 + i % 2, layer, v - 1 + i / 2);
      const bool solid =
          map_.shape.contains(cell) &&
          map_.cells[static_cast<std::size_t>(map_.shape.index(cell))] == CellState::kOccupied;
      if (solid) mask |= 1U << static_cast<unsigned>(i);
    }
    return mask;
  }

  [[nodiscard]] static bool isConvex(unsigned mask) {
    return mask == 1U || mask == 2U || mask == 4U || mask == 8U || mask == 6U || mask == 9U;
  }

  const VoxelMap& map_;
};

/// A stack of contacts as planned, and as they hang.
class HangingStack {
 public:
  HangingStack(const VoxelMap& map, const Eigen::Vector3d& reel, const HangingTether& tether)
      : edges_(map), reel_(reel), tether_(tether) {}

  void apply(ContactEvent& event) {
    event.length_before = length(event.vehicle);
    if (event.kind == ContactChange::kPop) {
      event.position = hung_.back();
      hung_.pop_back();
    } else {
      const std::optional<EdgeSpan> edge = edges_.spanAt(event.position);
      if (edge) {
        const double height = heightPassed(tether_, anchor(), event.position, event.vehicle);
        event.position.y() = std::clamp(height, edge->low, edge->high);
      }
      hung_.push_back(event.position);
    }
    event.length = length(event.vehicle);
  }

  [[nodiscard]] const std::vector<Eigen::Vector3d>& contacts() const noexcept { return hung_; }

  [[nodiscard]] double length(const Eigen::Vector3d& vehicle) const {
    double sum = 0.0;
    Eigen::Vector3d last = reel_;
    for (const Eigen::Vector3d& contact : hung_) {
      sum += (contact - last).norm();
      last = contact;
    }
    return sum + (vehicle - last).norm();
  }

 private:
  [[nodiscard]] const Eigen::Vector3d& anchor() const noexcept {
    return hung_.empty() ? reel_ : hung_.back();
  }

  UprightEdges edges_;
  Eigen::Vector3d reel_;
  HangingTether tether_;
  std::vector<Eigen::Vector3d> hung_;
};

}  // namespace

double heightPassed(const HangingTether& tether, const Eigen::Vector3d& anchor,
                    const Eigen::Vector3d& contact, const Eigen::Vector3d& vehicle) {
  const double r = levelDistance(anchor, vehicle);
  const double s = levelDistance(anchor, contact);
  if (s > r || tether.weight <= 0.0) return contact.y();
  const CatenaryInverse shape =
      solveInverseCatenary(r, vehicle.y() - anchor.y(), tether.tension, tether.weight);
  if (!shape || shape.H <= 0.0) return contact.y();
  const double a = shape.H / tether.weight;
  const double at_anchor = std::asinh(std::tan(shape.theta_A));
  return anchor.y() + a * (std::cosh(at_anchor + s / a) - std::cosh(at_anchor));
}

void hangContacts(const VoxelMap& map, const Eigen::Vector3d& reel, const HangingTether& tether,
                  ContactPlan& plan) {
  HangingStack stack(map, reel, tether);
  for (TetherState& state : plan.states) {
    for (ContactEvent& event : state.events) stack.apply(event);
    state.contacts = stack.contacts();
    state.length = stack.length(state.position);
  }
}

}  // namespace tautline::planning
