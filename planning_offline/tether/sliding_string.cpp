#include "planning_offline/tether/sliding_string.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/error.h"
#include "planning_offline/field/reel_place.h"
#include "planning_offline/tether/contact_tree.h"
#include "planning_offline/tether/edge_equilibrium.h"

namespace tautline::planning {
namespace {

// Lengths in cells.
constexpr double kStill = 1e-7;   // a bend nearer to its place of rest is there
constexpr double kBeyond = 1e-7;  // how far a bend is led off its edge's end; obstacles that go on
                                  // there are farther away (shrunk_solid.h)
constexpr double kTogether = 1e-7;  // bends so near to each other are at one corner
constexpr double kSame = 1e-9;      // bends of one edge so near to each other are one
constexpr double kPulled = 1e-9;    // growth of length with way below which nothing pulls
constexpr double kShorter = 1e-8;   // less is no gain
constexpr int kIdleMax = 8;         // slips without a gain, then the string hangs at a corner
constexpr int kJointRounds = 30;    // of the quick way to the place of rest, then the sure one
constexpr int kRoundsMax = 1000;
constexpr int kSweepsMax = 2000;  // a move; a few are usual

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
  sweeps_left_ = kSweepsMax;
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

double SlidingString::length() const { return lengthInCells() * resolution_; }

double SlidingString::lengthInCells() const {
  double cells = (end_ - before(bends_.size())).norm();
  for (std::size_t i = 0; i < bends_.size(); ++i) cells += (bends_[i].bend.at - before(i)).norm();
  return cells;
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

bool SlidingString::lead(Side& side, const Eigen::Vector3d& x, const Eigen::Vector3d& q) {
  return --sweeps_left_ >= 0 && sweep_.drag(side, x, q);
}

bool SlidingString::follow(const Eigen::Vector3d& q) {
  Side side(sweep_.solid(), reel_);
  side.bends().swap(bends_);
  const bool led = lead(side, end_, q);
  bends_.swap(side.bends());
  end_ = q;
  return led && relax();
}

bool SlidingString::relax() {
  double shortest = std::numeric_limits<double>::infinity();
  int idle = 0;  // slips since the string last got shorter
  for (int round = 0; round < kRoundsMax; ++round) {
    if (!settle()) return false;
    Slid slid = round < kJointRounds ? slideTogether() : slideOne();
    if (slid == Slid::kNot) {
      const double now = lengthInCells();
      idle = now < shortest - kShorter ? 0 : idle + 1;
      shortest = std::min(shortest, now);
      if (idle > kIdleMax) return true;
      slid = slipOne();
      if (slid == Slid::kNot) slid = turnCorner();
    }
    if (slid == Slid::kNot) return true;
    if (slid == Slid::kEndless) return false;
  }
  return false;
}

SlidingString::Slid SlidingString::slideTogether() {
  std::vector<SlidingPoint> rest;
  for (const Held& held : bends_) {
    rest.push_back({held.bend.at, held.bend.edge.axis, held.run.low, held.run.high});
  }
  findEquilibrium(reel_, end_, rest);
  Slid slid = Slid::kNot;
  // From the vehicle on, whose move it was.
  for (std::size_t i = rest.size(); i-- > 0 && slid <= Slid::kAlong;) {
    const double place = rest[i].at[rest[i].axis];
    if (std::abs(place - bends_[i].bend.place()) > kStill) slid = slide(i, place);
  }
  return slid;
}

SlidingString::Slid SlidingString::slideOne() {
  const double before_all = lengthInCells();
  for (std::size_t i = bends_.size(); i-- > 0;) {
    const Held held = bends_[i];
    SlidingPoint rest{held.bend.at, held.bend.edge.axis, held.run.low, held.run.high};
    findEquilibrium(before(i), after(i), {&rest, 1});
    const auto around = [&](const Eigen::Vector3d& at) {
      return (at - before(i)).norm() + (after(i) - at).norm();
    };
    if (around(rest.at) > around(held.bend.at) - kShorter) continue;
    // Other bends may be met on the way, and make it longer: not so a shorter way.
    const Bends start = bends_;
    for (double part = 1.0; part > 1e-3; part *= 0.5) {
      const double way = part * (rest.at[rest.axis] - held.bend.place());
      const Slid slid = slide(i, held.bend.place() + way);
      if (slid == Slid::kEndless) return slid;
      if (lengthInCells() < before_all) return slid;
      bends_ = start;
    }
  }
  return Slid::kNot;
}

int SlidingString::slipSign(std::size_t i) const {
  const auto& [bend, run] = bends_[i];
  if (run.slips_high && bend.place() >= run.high - kTogether) return 1;
  return run.slips_low && bend.place() <= run.low + kTogether ? -1 : 0;
}

SlidingString::Slid SlidingString::slipOne() {
  for (std::size_t end = bends_.size(); end > 0;) {
    const std::size_t first = cornerBefore(end);
    Eigen::Vector3d off = bends_[end - 1].bend.at;
    bool slips = true;
    for (std::size_t i = first; i < end; ++i) {
      const int axis = bends_[i].bend.edge.axis;
      const int sign = slipSign(i);
      // Of a bend alone it is known which way it is pulled. Several at one corner hide that from
      // each other: they are led off it, and what is left of them is seen then.
      const bool alone = end - first == 1;
      const double pull = -slope(before(i), bends_[i].bend.at, axis, after(i));
      slips = slips && sign != 0 && (!alone || sign * pull > kPulled);
      off[axis] += sign * kBeyond;
    }
    if (slips) return slip(first, end, off);
    end = first;
  }
  return Slid::kNot;
}

std::size_t SlidingString::cornerBefore(std::size_t end) const {
  std::size_t first = end - 1;
  while (first > 0 && (before(first) - bends_[first].bend.at).norm() < kTogether) --first;
  return first;
}

SlidingString::Slid SlidingString::turnCorner() {
  for (std::size_t end = bends_.size(); end > 0; end = cornerBefore(end)) {
    const auto [bend, run] = bends_[end - 1];  // what is tried moves bends_
    if (std::min(bend.place() - run.low, run.high - bend.place()) > kTogether) continue;
    const std::size_t first = cornerBefore(end);
    for (const ShrunkSolid::EdgeEnd& onto : sweep_.solid().edgesFrom(bend.at)) {
      const double pull = -slope(before(first), bend.at, onto.edge.axis, after(end - 1));
      if (onto.side * pull > kPulled && turnCorner(first, end, onto)) return Slid::kOverOthers;
    }
  }
  return Slid::kNot;
}

bool SlidingString::turnCorner(std::size_t first, std::size_t end,
                               const ShrunkSolid::EdgeEnd& onto) {
  const Bends start = bends_;
  const double longest = lengthInCells() - kShorter;
  const Eigen::Vector3d& corner = bends_[end - 1].bend.at;
  const Eigen::Vector3d at =
      sweep_.solid().pointOn(onto.edge, corner[onto.edge.axis] + 10.0 * onto.side * kBeyond);
  Side reel_side(sweep_.solid(), reel_);
  Side end_side(sweep_.solid(), end_);
  bool led = sweepBoth(reel_side, end_side, first, end, at);
  // The edge holds the string if it lies within the bend.
  const Eigen::Vector2d in = across(onto.edge.axis, at - reel_side.anchor());
  const Eigen::Vector2d out = across(onto.edge.axis, end_side.anchor() - at);
  const int turn = in.x() * out.y() - in.y() * out.x() > 0.0 ? 1 : -1;
  const auto ahead = [&](const Eigen::Vector2d& way) {
    return turn * onto.edge.sideV() * way.x() >= 0.0 && -turn * onto.edge.sideU() * way.y() >= 0.0;
  };
  if (led && ahead(in) && ahead(out)) {
    reel_side.push({at, onto.edge, turn});
  } else {
    led = led && lead(reel_side, at, end_side.anchor());
  }
  bends_ = std::move(reel_side.bends());
  bends_.insert(bends_.end(), end_side.bends().rbegin(), end_side.bends().rend());
  for (int round = 0; led && round < kJointRounds; ++round) {
    led = settle();
    if (!led || lengthInCells() < longest) break;
    const Slid slid = slideOne();
    if (slid == Slid::kNot) break;
    led = slid != Slid::kEndless;
  }
  if (led && lengthInCells() < longest) return true;
  bends_ = start;
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

bool SlidingString::sweepBoth(Side& reel_side, Side& end_side, std::size_t first, std::size_t end,
                              const Eigen::Vector3d& to) {
  const auto at = [this](std::size_t i) { return bends_.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto turnOver = [&end_side] {
    for (Held& held : end_side.bends()) held.bend.turn = -held.bend.turn;
  };
  reel_side.bends().assign(bends_.begin(), at(first));
  end_side.bends().assign(bends_.rbegin(), std::make_reverse_iterator(at(end)));
  turnOver();
  const bool led =
      lead(reel_side, bends_[first].bend.at, to) && lead(end_side, bends_[end - 1].bend.at, to);
  turnOver();
  return led;
}

SlidingString::Slid SlidingString::slide(std::size_t i, double place) {
  Held held = bends_[i];
  held.bend.at[held.bend.edge.axis] = place;
  Side reel_side(sweep_.solid(), reel_);
  Side end_side(sweep_.solid(), end_);
  if (!sweepBoth(reel_side, end_side, i, i + 1, held.bend.at)) return Slid::kEndless;
  bends_ = std::move(reel_side.bends());
  bends_.push_back(held);
  bends_.insert(bends_.end(), end_side.bends().rbegin(), end_side.bends().rend());
  return reel_side.changed() || end_side.changed() ? Slid::kOverOthers : Slid::kAlong;
}

SlidingString::Slid SlidingString::slip(std::size_t first, std::size_t end,
                                        const Eigen::Vector3d& off) {
  Side reel_side(sweep_.solid(), reel_);
  Side end_side(sweep_.solid(), end_);
  const bool led =
      sweepBoth(reel_side, end_side, first, end, off) && lead(reel_side, off, end_side.anchor());
  if (!led) return Slid::kEndless;
  bends_ = std::move(reel_side.bends());
  bends_.insert(bends_.end(), end_side.bends().rbegin(), end_side.bends().rend());
  return Slid::kOverOthers;
}

bool SlidingString::straighten(std::size_t i) {
  const auto at = bends_.begin() + static_cast<std::ptrdiff_t>(i);
  Side reel_side(sweep_.solid(), reel_);
  reel_side.bends().assign(bends_.begin(), at);
  const Bends rest(at + 1, bends_.end());
  if (!lead(reel_side, at->bend.at, after(i))) return false;
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
    if (!sweep_.free(before(i), to)) return false;
  }
  return true;
}

}  // namespace tautline::planning
