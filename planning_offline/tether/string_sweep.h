#pragma once

/// @file
/// A string anchored at one end sweeps over the obstacles' edges while its other end moves in a
/// straight line: bends are made where it meets an edge, and undone where it is straight again. The
/// one mechanism under the pinned and the frictionless string (docs/taut_string.md). All decisions
/// are taken against the shrunk obstacles (shrunk_solid.h). Lengths in cells. Not real-time safe:
/// offline only.

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/near_field.h"
#include "planning_offline/tether/shrunk_solid.h"

namespace tautline::planning {

/// Where the string bends: a point on a (shrunk) edge.
struct Bend {
  Eigen::Vector3d at{Eigen::Vector3d::Zero()};
  ConvexEdge edge;
  int turn{0};  ///< +1 counter-clockwise about the edge's axis, −1 clockwise, seen along the string
                ///< away from its anchored end.

  [[nodiscard]] double place() const noexcept { return at[edge.axis]; }  ///< Along the edge.
  /// The same place on the edge of the obstacles as they are.
  [[nodiscard]] Eigen::Vector3d onTrueEdge() const noexcept {
    Eigen::Vector3d point = at;
    point[axisU(edge.axis)] = edge.u;
    point[axisV(edge.axis)] = edge.v;
    return point;
  }
};

/// A contact nearer than this to its neighbours' chord [cells] is straight.
inline constexpr double kGrazing = 1e-5;

/// Twice the signed area that the string a – bend – b spans about the bend's edge, positive while
/// it bends round it.
[[nodiscard]] double bendArea(const Bend& bend, const Eigen::Vector3d& a,
                              const Eigen::Vector3d& b) noexcept;

class StringSweep {
 public:
  /// Keeps a copy of the map's cells.
  explicit StringSweep(const VoxelMap& map) : solid_(map) {}

  [[nodiscard]] const ShrunkSolid& solid() const noexcept { return solid_; }

  /// Leads the end of a taut string from x straight to q. False if that takes more events than any
  /// string needs; `stack` is then somewhere on the way. A Stack has the bends from the anchored
  /// end on:
  ///
  ///     bool empty() const
  ///     Eigen::Vector3d anchor() const        of the free part: the last bend, or the anchored end
  ///     Eigen::Vector3d anchorBelow() const   of the part before it; not if empty()
  ///     Bend last() const                     not if empty()
  ///     void pop()                            not if empty()
  ///     void push(const Bend&)
  template <class Stack>
  [[nodiscard]] bool drag(Stack& stack, Eigen::Vector3d x, const Eigen::Vector3d& q);

  /// True if the straight line does not penetrate an obstacle.
  [[nodiscard]] bool free(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const noexcept {
    return !solid_.penetrated(a, b, solid_.field().near(a, b, b).occupied);
  }
  /// The same for the free part that the last drag() left, from its anchor to its end: what that
  /// sweep found near is asked for no second time. No other drag() may be in between.
  [[nodiscard]] bool freeAfterDrag(const Eigen::Vector3d& anchor,
                                   const Eigen::Vector3d& end) const noexcept {
    return !solid_.penetrated(anchor, end, near_.occupied);
  }

  /// By how much to pass a way's middle aside where two events on it came too close to each other
  /// to be told apart.
  static const std::array<Eigen::Vector3d, 6>& asides();

 private:
  /// A way of the string's end, and an axis whose edges cannot be met on it (kNoAxis: none).
  static constexpr int kNoAxis = -1;
  struct Leg {
    Eigen::Vector3d target;
    int dead_axis;
  };

  /// The string meets an edge when its end is at `part` of the way, at `reach` of its free length.
  struct Meeting {
    double part;
    double reach;
    Bend bend;
  };

  /// At which part of the way of its end from x the string is straight over its last bend.
  [[nodiscard]] static std::optional<double> release(const Bend& last, const Eigen::Vector3d& below,
                                                     const Eigen::Vector3d& x, const Leg& leg);
  /// First edge that the string from c meets while its end goes from p along the leg.
  [[nodiscard]] std::optional<Meeting> firstMeeting(const Eigen::Vector3d& c,
                                                    const Eigen::Vector3d& p, const Leg& leg);
  /// Looks where near_ says that edges are.
  void meetEdges(int axis, const Eigen::Vector3d& c, const Eigen::Vector3d& p,
                 const Eigen::Vector3d& q, std::optional<Meeting>& first) const;

  ShrunkSolid solid_;
  NearField::Near near_;   ///< Of the last sweep.
  std::vector<Leg> legs_;  ///< Ways still to go, the next one last; kept for its memory.
};

template <class Stack>
bool StringSweep::drag(Stack& stack, Eigen::Vector3d x, const Eigen::Vector3d& q) {
  constexpr int kEventsMax = 1000;
  legs_.assign(1, {q, kNoAxis});
  for (int events = 0; events < kEventsMax; ++events) {
    Leg& leg = legs_.back();
    const Eigen::Vector3d c = stack.anchor();
    const std::optional<double> straight =
        stack.empty() ? std::nullopt : release(stack.last(), stack.anchorBelow(), x, leg);
    const std::optional<Meeting> meeting = firstMeeting(c, x, leg);
    if (meeting && (!straight || meeting->part < *straight)) {
      x += meeting->part * (leg.target - x);
      stack.push(meeting->bend);
    } else if (straight) {
      // The string swings off the bend: its end goes there and comes back along the string, in a
      // plane along the edge, so that no edge parallel to it can be met or released. What is left
      // of this leg is then seen from another anchor.
      const Eigen::Vector3d back = x + *straight * (leg.target - x);
      const int axis = stack.last().edge.axis;
      leg.dead_axis = kNoAxis;
      stack.pop();
      x = c;
      legs_.push_back({back, axis});
    } else {
      x = leg.target;
      legs_.pop_back();
      if (legs_.empty()) return true;
    }
  }
  return false;
}

}  // namespace tautline::planning
