#include "planning_offline/tether/sliding_string.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.h"
#include "planning_offline/tether/contact_tree.h"
#include "planning_offline/tether/edge_equilibrium.h"
#include "planning_offline/tether/reel_place.h"

namespace tautline::planning {
namespace {

// Lengths in cells.
constexpr double kStill = 1e-7;   // a bend nearer to its place of rest is there
constexpr double kBeyond = 1e-7;  // how far a bend is led off its edge's end; obstacles that go on
                                  // there are farther away (shrunk_solid.h)
constexpr double kSame = 1e-9;    // bends of one edge so near to each other are one
constexpr int kRoundsMax = 200;

}  // namespace

/// The bends on one side of a point of the string, seen from their far end.
class SlidingString::Side {
 public:
  Side(const ShrunkSolid& solid, const Eigen::Vector3d& root) : solid_(solid), root_(root) {}

  [[nodiscard]] bool empty() const { return bends_.empty(); }
  [[nodiscard]] const Eigen::Vector3d& anchor() const {
    return bends_.empty() ? root_ : bends_.back().bend.at;
  }
  [[nodiscard]] const Eigen::Vector3d& anchorBelow() const {
    return bends_.size() > 1 ? bends_[bends_.size() - 2].bend.at : root_;
  }
  [[nodiscard]] const Bend& last() const { return bends_.back().bend; }
  void pop() {
    bends_.pop_back();
    changed_ = true;
  }
  void push(const Bend& bend) {
    bends_.push_back({bend, solid_.runAround(bend.edge, bend.place())});
    changed_ = true;
  }

  [[nodiscard]] Bends& bends() { return bends_; }
  [[nodiscard]] bool changed() const { return changed_; }  ///< By pop() or push().

 private:
  const ShrunkSolid& solid_;
  Eigen::Vector3d root_;
  Bends bends_;
  bool changed_{false};
};

SlidingString::SlidingString(const VoxelMap& map, const Eigen::Vector3d& reel)
    : origin_(map.origin),
      resolution_(map.resolution),
      sweep_(map),
      reel_((checkedReel(map, reel) - origin_) / resolution_),
      end_(reel_) {}

void SlidingString::moveTo(const Eigen::Vector3d& p_M) {
  const Eigen::Vector3d q = (p_M - origin_) / resolution_;
  TAUTLINE_CHECK((q.array().abs() <= kFarthest).all());
  const Bends bends = bends_;
  const Eigen::Vector3d from = end_;
  if (follow(q) && free()) return;
  const Bends direct = std::exchange(bends_, bends);
  for (const Eigen::Vector3d& aside : StringSweep::asides()) {
    bends_ = bends;
    end_ = from;
    if (follow(0.5 * (from + q) + aside) && follow(q) && free()) return;
  }
  ++unresolved_;
  bends_ = direct;
  end_ = q;
}

double SlidingString::length() const {
  double cells = (end_ - before(bends_.size())).norm();
  for (std::size_t i = 0; i < bends_.size(); ++i) cells += (bends_[i].bend.at - before(i)).norm();
  return cells * resolution_;
}

std::vector<Eigen::Vector3d> SlidingString::contacts() const {
  std::vector<Eigen::Vector3d> points{reel_};
  const auto add = [&points](const Eigen::Vector3d& p) {
    if (points.size() > 1 && distanceToSegment(points.back(), *(points.rbegin() + 1), p) < kGrazing)
      points.pop_back();
    points.push_back(p);
  };
  for (const Held& held : bends_) add(held.bend.onTrueEdge());
  add(end_);
  points.pop_back();
  points.erase(points.begin());
  for (Eigen::Vector3d& point : points) point = origin_ + resolution_ * point;
  return points;
}

bool SlidingString::follow(const Eigen::Vector3d& q) {
  Side side(sweep_.solid(), reel_);
  side.bends().swap(bends_);
  const bool led = sweep_.drag(side, end_, q);
  bends_.swap(side.bends());
  end_ = q;
  return led && relax();
}

bool SlidingString::relax() {
  std::vector<SlidingPoint> rest;
  for (int round = 0; round < kRoundsMax; ++round) {
    if (!settle()) return false;
    rest.clear();
    for (const Held& held : bends_) {
      rest.push_back({held.bend.at, held.bend.edge.axis, held.run.low, held.run.high});
    }
    findEquilibrium(reel_, end_, rest);
    bool still = true;
    for (std::size_t i = rest.size(); i-- > 0 && i < bends_.size();) {
      const int axis = rest[i].axis;
      const double place = rest[i].at[axis];
      const double pull = -slope(i > 0 ? rest[i - 1].at : reel_, rest[i].at, axis,
                                 i + 1 < rest.size() ? rest[i + 1].at : end_);
      const EdgeRun& run = bends_[i].run;
      const bool slips = (run.slips_high && place >= run.high && pull > 0.0) ||
                         (run.slips_low && place <= run.low && pull < 0.0);
      if (!slips && std::abs(place - bends_[i].bend.place()) <= kStill) continue;
      still = false;
      const Slid slid = slide(i, place, slips);
      if (slid == Slid::kEndless) return false;
      if (slid == Slid::kOverOthers) break;
    }
    if (still) return true;
  }
  return false;
}

bool SlidingString::settle() {
  for (int round = 0; round < kRoundsMax; ++round) {
    std::size_t loose = bends_.size();
    for (std::size_t i = 0; i < bends_.size() && loose == bends_.size(); ++i) {
      const Bend& bend = bends_[i].bend;
      const bool twice = i + 1 < bends_.size() &&
                         bends_[i + 1].bend.edge.packed() == bend.edge.packed() &&
                         bends_[i + 1].run.low == bends_[i].run.low;
      if (twice || bendArea(bend, before(i), after(i)) <= 0.0) loose = i;
    }
    if (loose == bends_.size()) return true;
    if (!straighten(loose)) return false;
  }
  return false;
}

SlidingString::Slid SlidingString::slide(std::size_t i, double place, bool slips) {
  const Held held = bends_[i];
  double to = place;
  if (slips) to += place >= held.run.high ? kBeyond : -kBeyond;
  const Eigen::Vector3d& x = held.bend.at;
  const Eigen::Vector3d q = sweep_.solid().pointOn(held.bend.edge, to);
  const auto at = bends_.begin() + static_cast<std::ptrdiff_t>(i);
  Side reel_side(sweep_.solid(), reel_);
  reel_side.bends().assign(bends_.begin(), at);
  Side end_side(sweep_.solid(), end_);
  end_side.bends().assign(bends_.rbegin(), std::make_reverse_iterator(at + 1));
  const auto turnOver = [&end_side] {
    for (Held& other : end_side.bends()) other.bend.turn = -other.bend.turn;
  };
  turnOver();
  if (!sweep_.drag(reel_side, x, q) || !sweep_.drag(end_side, x, q)) return Slid::kEndless;
  turnOver();
  if (slips && !sweep_.drag(reel_side, q, end_side.anchor())) return Slid::kEndless;
  const bool same = !slips && !reel_side.changed() && !end_side.changed();
  bends_ = std::move(reel_side.bends());
  if (!slips) {
    bends_.push_back(held);
    bends_.back().bend.at = q;
  }
  bends_.insert(bends_.end(), end_side.bends().rbegin(), end_side.bends().rend());
  return same ? Slid::kAlong : Slid::kOverOthers;
}

bool SlidingString::straighten(std::size_t i) {
  const auto at = bends_.begin() + static_cast<std::ptrdiff_t>(i);
  Side reel_side(sweep_.solid(), reel_);
  reel_side.bends().assign(bends_.begin(), at);
  const Bends rest(at + 1, bends_.end());
  if (!sweep_.drag(reel_side, at->bend.at, after(i))) return false;
  bends_ = std::move(reel_side.bends());
  // The end of that sweep may meet the very edge that it came to.
  if (!bends_.empty() && !rest.empty() &&
      (bends_.back().bend.at - rest.front().bend.at).norm() < kSame) {
    bends_.pop_back();
  }
  bends_.insert(bends_.end(), rest.begin(), rest.end());
  return true;
}

bool SlidingString::free() const {
  for (std::size_t i = 0; i <= bends_.size(); ++i) {
    const Eigen::Vector3d& to = i < bends_.size() ? bends_[i].bend.at : end_;
    if (sweep_.solid().penetrated(before(i), to)) return false;
  }
  return true;
}

}  // namespace tautline::planning
