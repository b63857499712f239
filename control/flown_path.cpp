#include "control/flown_path.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "control/segment.h"

namespace tautline {
namespace {

constexpr double kCoarsest = 1000.0;  // [m] thinner makes no room that this does not make
constexpr int kThinned = FlownPath::kMaxPoints * 3 / 4;

}  // namespace

void FlownPath::begin(const Eigen::Vector3d& p_WHome) noexcept {
  points_[0] = {.p_WD = p_WHome};
  count_ = 1;
  bend_count_ = 1;
  bend_ = 0;
}

void FlownPath::record(const Eigen::Vector3d& p_WD, const ContactStack& contacts,
                       bool tether_known) noexcept {
  if (!known()) return;
  const int bend = bendOf(contacts);
  if (bend == kMaxBends) return clear();
  if (bend != bend_) {
    append({.p_WD = p_WD, .bend = bend_});
    const int bend_before = std::exchange(bend_, bend);
    if (tether_known) forgetContact(bend_before);
    return;
  }
  if ((p_WD - point(count_ - 1)).norm() < kSpacing) return;
  if (tether_known) forgetLoop(p_WD);
  append({.p_WD = p_WD, .bend = bend_});
}

void FlownPath::cutAfter(int i) noexcept {
  if (i + 1 >= count_) return;
  bend_ = at(i + 1).bend;
  count_ = i + 1;
  dropUnusedBends();
}

int FlownPath::joinFrom(const Eigen::Vector3d& p_WD) const noexcept {
  constexpr int kMostPassed = 16;
  int join = count_ - 1;
  const auto passesAll = [&](int target) {
    for (int i = target + 1; i < count_; ++i) {
      if (projectOnSegment(point(i), p_WD, point(target)).cross_track > kSamePlace) return false;
    }
    return true;
  };
  while (join > 0 && count_ - join <= kMostPassed && at(join).bend == bend_ && passesAll(join - 1))
    --join;
  return join;
}

ContactStack::Change FlownPath::restore(int i, ContactStack& contacts) const noexcept {
  std::array<int, kMaxBends> chain{};
  std::size_t depth = 0;
  for (int b = at(i).bend; b != 0; b = bend(b).below) chain[depth++] = b;
  contacts.clear();
  while (depth > 0) {
    const Bend& next = bend(chain[--depth]);
    const ContactStack::Change change = contacts.push(next.id, next.p_WC);
    if (change != ContactStack::Change::kPushed) return change;
  }
  return ContactStack::Change::kNone;
}

/// Index of the stack in the tree, where it is added if it is new; kMaxBends if there is no room.
int FlownPath::bendOf(const ContactStack& contacts) noexcept {
  int found = 0;
  for (int c = 1; c <= contacts.contactCount(); ++c) {
    const int below = found;
    const auto is = [&](const Bend& b) {
      return b.below == below && b.id == contacts.id(c) && b.p_WC == contacts.point(c);
    };
    found = 1;
    while (found < bend_count_ && !is(bend(found))) ++found;
    if (found < bend_count_) continue;
    if (bend_count_ == kMaxBends) return kMaxBends;
    bends_[static_cast<std::size_t>(bend_count_++)] = {
        .id = contacts.id(c), .p_WC = contacts.point(c), .below = below};
  }
  return found;
}

void FlownPath::append(Point point) noexcept {
  if (count_ == kMaxPoints) {
    for (double t = 2.0 * kTolerance; count_ > kThinned && t < kCoarsest; t *= 2.0) thin(t);
    if (count_ == kMaxPoints) return clear();
  }
  points_[static_cast<std::size_t>(count_++)] = point;
  thin(kTolerance);
}

/// To the first place of the path where this one is, on the same stack.
void FlownPath::forgetLoop(const Eigen::Vector3d& p_WD) noexcept {
  double way = (p_WD - point(count_ - 1)).norm();
  std::optional<Point> first;
  int first_piece = 0;
  for (int i = count_ - 1; i > 0; --i) {
    const SegmentProgress here = projectOnSegment(p_WD, point(i - 1), point(i));
    if (at(i).bend == bend_ && here.cross_track < kSamePlace &&
        way + (point(i) - here.closest).norm() - here.cross_track > kLeastLoop) {
      first = {.p_WD = here.closest, .bend = bend_, .error = at(i).error};
      first_piece = i;
    }
    way += here.length;
  }
  if (first) cutTo(first_piece, *first);
}

/// A contact is made, and comes off, where the drone is on the line from the anchor below it
/// through it: the tether itself has lain on the straight way from the one place to the other.
void FlownPath::forgetContact(int bend_before) noexcept {
  int off = bend_before;
  while (off != 0 && bend(off).below != bend_) off = bend(off).below;
  if (off == 0) return;  // none came off
  int made = count_ - 1;
  while (made > 0 && at(made).bend != bend_) --made;
  const auto isOnTether = [&](const Eigen::Vector3d& p_WD) {
    const SegmentProgress here = projectOnSegment(p_WD, bend(bend_).p_WC, bend(off).p_WC);
    return here.along > here.length && here.off_line < kOnTether;
  };
  const Point last{.p_WD = point(count_ - 1), .bend = bend_};
  if (isOnTether(point(made)) && isOnTether(last.p_WD)) cutTo(made + 1, last);
}

/// Keeps the first `count` points and ends with `last`.
void FlownPath::cutTo(int count, const Point& last) noexcept {
  points_[static_cast<std::size_t>(count)] = last;
  count_ = count + 1;
  dropUnusedBends();
}

/// Leaves out every point that is no contact's and near enough to the line between the one kept
/// before it and the one after it. What a longer piece has left out is within the larger error of
/// its two parts, and these within the distance of their common point.
void FlownPath::thin(double tolerance) noexcept {
  int kept = std::min(count_, 1);
  for (int i = kept; i < count_; ++i) {
    Point& here = points_[static_cast<std::size_t>(i)];
    if (i + 1 < count_) {
      Point& next = points_[static_cast<std::size_t>(i + 1)];
      const double off = projectOnSegment(here.p_WD, point(kept - 1), next.p_WD).cross_track;
      const double error = std::max(here.error, next.error) + off;
      if (here.bend == next.bend && error <= tolerance) {
        next.error = error;
        continue;
      }
    }
    points_[static_cast<std::size_t>(kept++)] = here;
  }
  count_ = kept;
}

void FlownPath::dropUnusedBends() noexcept {
  int last = bend_;
  for (int i = 1; i < count_; ++i) last = std::max(last, at(i).bend);
  bend_count_ = last + 1;
}

}  // namespace tautline
