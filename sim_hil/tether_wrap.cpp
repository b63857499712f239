#include "sim_hil/tether_wrap.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tautline::sim {
namespace {

constexpr double kSlideGain = 0.2;     // part of the way to the friction cone in one step
constexpr double kMaxSlide = 0.005;    // in one step [m]
constexpr double kNodeReached = 5e-4;  // nearer than this a node has reached the bend [m]

std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

}  // namespace

std::span<const EdgeContact> TetherWrap::on(int link) const noexcept {
  int first = 0;
  while (first < count_ && bend_[at(first)].link < link) ++first;
  int last = first;
  while (last < count_ && bend_[at(last)].link == link) ++last;
  return {bend_.data() + first, at(last - first)};
}

bool TetherWrap::touches(int link, int obstacle, const Obstacles& obstacles) const noexcept {
  const auto bends = on(link);
  return std::any_of(bends.begin(), bends.end(), [&](const EdgeContact& b) {
    return obstacles.solids()[at(b.solid)].obstacle == obstacle;
  });
}

void TetherWrap::add(const ConvexPrism& prism, int solid, int link, const SegmentContact& contact,
                     const Eigen::Vector3d& x_j, const Eigen::Vector3d& x_k) noexcept {
  if (count_ == kMaxEdgeContacts) return;
  for (const EdgeContact& b : all()) {
    if (b.solid == solid && b.feature == contact.feature && std::abs(b.link - link) <= 1) return;
  }
  EdgeContact bend;
  bend.link = link;
  bend.solid = solid;
  bend.feature = contact.feature;
  bend.edge = edgeOf(prism, contact.feature);
  const Eigen::Vector3d p = x_j + contact.s * (x_k - x_j);
  bend.along = std::clamp((p - bend.edge.start).dot(bend.edge.direction), 0.0, bend.edge.length);
  // Before the first bend that is farther along the tether.
  const Eigen::Vector3d t = x_k - x_j;
  int place = 0;
  while (place < count_ && (bend_[at(place)].link < link ||
                            (bend_[at(place)].link == link &&
                             (bend_[at(place)].point() - bend.point()).dot(t) < 0.0))) {
    ++place;
  }
  for (int i = count_; i > place; --i) bend_[at(i)] = bend_[at(i - 1)];
  bend_[at(place)] = bend;
  ++count_;
}

void TetherWrap::remove(int i) noexcept {
  for (int k = i + 1; k < count_; ++k) bend_[at(k - 1)] = bend_[at(k)];
  --count_;
}

void TetherWrap::update(std::span<const Eigen::Vector3d> x, double friction) noexcept {
  const int links = static_cast<int>(x.size()) - 1;
  for (int i = 0; i < count_;) {
    EdgeContact& bend = bend_[at(i)];
    const bool first = i == 0 || bend_[at(i - 1)].link != bend.link;
    const bool last = i + 1 == count_ || bend_[at(i + 1)].link != bend.link;
    const Eigen::Vector3d before = first ? x[at(bend.link)] : bend_[at(i - 1)].point();
    const Eigen::Vector3d after = last ? x[at(bend.link + 1)] : bend_[at(i + 1)].point();
    slide(bend, before, after, friction);
    const Eigen::Vector3d c = bend.point();
    const Eigen::Vector3d pull = (after - c).normalized() - (c - before).normalized();
    const bool off_end = bend.along < 0.0 || bend.along > bend.edge.length;
    if (off_end || pull.dot(bend.edge.outward) >= 0.0) {
      remove(i);
      continue;
    }
    if (first && bend.link > 0 && (c - before).norm() < kNodeReached) {
      --bend.link;
    } else if (last && bend.link + 1 < links && (after - c).norm() < kNodeReached) {
      ++bend.link;
    }
    ++i;
  }
}

/// Along the edge the tether slides until its pull is back in the friction cone.
void TetherWrap::slide(EdgeContact& bend, const Eigen::Vector3d& before,
                       const Eigen::Vector3d& after, double friction) const noexcept {
  const Eigen::Vector3d a = bend.point() - before;
  const Eigen::Vector3d b = after - bend.point();
  const Eigen::Vector3d pull = b.normalized() - a.normalized();
  const double sideways = pull.dot(bend.edge.direction);
  const double into = (pull - sideways * bend.edge.direction).norm();
  const double excess = std::abs(sideways) - friction * into;
  if (excess <= 0.0) return;
  const double way = kSlideGain * excess / (1.0 / a.norm() + 1.0 / b.norm());
  bend.along += std::copysign(std::fmin(way, kMaxSlide), sideways);
}

TetherWrap::Way TetherWrap::wayOf(std::span<const EdgeContact> bends, const Eigen::Vector3d& x_j,
                                  const Eigen::Vector3d& x_k) noexcept {
  Way way;
  Eigen::Vector3d from = x_j;
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i <= bends.size(); ++i) {
    const Eigen::Vector3d to = i < bends.size() ? bends[i].point() : x_k;
    const Eigen::Vector3d d = to - from;
    const double length = std::fmax(d.norm(), 1e-6);
    const Eigen::Vector3d direction = d / length;
    if (i == 0) {
      way.first = length;
      way.t_first = direction;
    } else {
      way.turn += std::atan2(t.cross(direction).norm(), t.dot(direction));
    }
    way.length += length;
    way.last = length;
    way.t_last = direction;
    t = direction;
    from = to;
  }
  return way;
}

}  // namespace tautline::sim
