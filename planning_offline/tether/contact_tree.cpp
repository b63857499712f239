#include "planning_offline/tether/contact_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.h"

namespace tautline::planning {

double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) noexcept {
  const Eigen::Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

ContactTree::ContactTree(const Eigen::Vector3d& reel, double grazing) : grazing_(grazing) {
  nodes_.emplace_back().point = reel;
}

void ContactTree::forbid(NoContactCells cells) {
  TAUTLINE_CHECK(nodes_.size() == 1);
  no_contact_ = std::move(cells);
}

std::size_t ContactTree::ChildHash::operator()(const Child& child) const noexcept {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;  // 2^64 / golden ratio: spreads all bits
  std::uint64_t h = child.parent;
  for (const std::uint64_t part : {child.key.edge, static_cast<std::uint64_t>(child.key.place),
                                   static_cast<std::uint64_t>(child.key.turn)}) {
    h = (h ^ part) * kOdd;
    h ^= h >> 32;
  }
  return h;
}

const ContactTree::Node& ContactTree::node(StackId stack) const {
  TAUTLINE_CHECK(stack < nodes_.size());
  return nodes_[stack];
}

StackId ContactTree::push(StackId stack, const ContactKey& key, const Eigen::Vector3d& point) {
  const auto id = static_cast<StackId>(nodes_.size());
  const auto [known, added] = children_.try_emplace({stack, key}, id);
  if (!added) return known->second;
  TAUTLINE_CHECK(id < std::numeric_limits<StackId>::max());
  const Node& below = node(stack);
  const bool straight = stack != kStraight &&
                        distanceToSegment(below.point, node(below.listed).point, point) < grazing_;
  const StackId listed = straight ? below.listed : stack;
  nodes_.push_back({.parent = stack,
                    .listed = listed,
                    .count = node(listed).count + 1,
                    .forbidden = node(listed).forbidden || no_contact_.touchedAt(point),
                    .key = key,
                    .point = point,
                    .static_length = below.static_length + (point - below.point).norm()});
  return id;
}

std::vector<Eigen::Vector3d> ContactTree::contacts(StackId stack) const {
  std::vector<Eigen::Vector3d> points;
  for (StackId s = stack; s != kStraight; s = node(s).listed) points.push_back(node(s).point);
  std::reverse(points.begin(), points.end());
  return points;
}

}  // namespace tautline::planning
