#include "planning_offline/tether/test/bead_chain.h"

#include <algorithm>
#include <utility>

#include "planning_offline/tether/test/string_line.h"

namespace tautline::planning {
namespace {

// In cells.
constexpr double kSample = 0.02;   // between samples of a line
constexpr double kSpacing = 0.12;  // of beads
constexpr double kSkin = 1e-5;     // so deep in an obstacle still is its surface
constexpr double kShorter = 1e-4;  // a round that shortens less is the last

/// Points in cells.
class BeadChain {
 public:
  BeadChain(const VoxelMap& map, std::vector<Eigen::Vector3d> beads)
      : map_(map), beads_(std::move(beads)) {}

  void tighten();
  [[nodiscard]] double length() const;

 private:
  using Point = Eigen::Vector3d;

  [[nodiscard]] bool solid(const Point& p) const;
  [[nodiscard]] bool freeLine(const Point& a, const Point& b) const;
  /// No obstacle in the triangle, by lines from a to the side b – c.
  [[nodiscard]] bool freeTriangle(const Point& a, const Point& b, const Point& c) const;
  /// True if beads first … end − 1 may all go by the same way, their neighbours staying.
  [[nodiscard]] bool mayMove(std::size_t first, std::size_t end, const Point& by) const;
  /// Moves them if some small way makes the chain shorter.
  [[nodiscard]] bool moveBeads(std::size_t first, std::size_t end);
  void moveAll();
  void subdivide();
  void thin();

  const VoxelMap& map_;
  std::vector<Point> beads_;
};

bool BeadChain::solid(const Point& p) const {
  return depth(map_, map_.origin + map_.resolution * p) > kSkin;
}

bool BeadChain::freeLine(const Point& a, const Point& b) const {
  const int samples = 1 + static_cast<int>((b - a).norm() / kSample);
  for (int k = 0; k <= samples; ++k) {
    if (solid(a + (b - a) * k / samples)) return false;
  }
  return true;
}

bool BeadChain::freeTriangle(const Point& a, const Point& b, const Point& c) const {
  const int lines = 1 + static_cast<int>((c - b).norm() / kSample);
  for (int k = 0; k <= lines; ++k) {
    if (!freeLine(a, b + (c - b) * k / lines)) return false;
  }
  return true;
}

bool BeadChain::mayMove(std::size_t first, std::size_t end, const Point& by) const {
  if (!freeTriangle(beads_[first - 1], beads_[first], beads_[first] + by)) return false;
  for (std::size_t i = first; i + 1 < end; ++i) {
    if (!freeTriangle(beads_[i], beads_[i + 1], beads_[i + 1] + by)) return false;
    if (!freeTriangle(beads_[i + 1] + by, beads_[i], beads_[i] + by)) return false;
  }
  return freeTriangle(beads_[end], beads_[end - 1], beads_[end - 1] + by);
}

bool BeadChain::moveBeads(std::size_t first, std::size_t end) {
  const auto around = [&](const Point& by) {
    return (beads_[first] + by - beads_[first - 1]).norm() +
           (beads_[end] - beads_[end - 1] - by).norm();
  };
  const double now = around(Point::Zero());
  for (const double step : {0.1, 0.03, 0.01}) {
    for (int n = 0; n < 27; ++n) {
      if (n == 13) continue;
      const Point way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      const Point by = step * way.normalized();
      if (around(by) > now - 1e-4 * step || !mayMove(first, end, by)) continue;
      for (std::size_t i = first; i < end; ++i) beads_[i] += by;
      return true;
    }
  }
  return false;
}

void BeadChain::subdivide() {
  std::vector<Point> fine{beads_.front()};
  for (std::size_t i = 1; i < beads_.size(); ++i) {
    const Point from = beads_[i - 1];
    const int parts = 1 + static_cast<int>((beads_[i] - from).norm() / kSpacing);
    for (int k = 1; k <= parts; ++k) fine.push_back(from + (beads_[i] - from) * k / parts);
  }
  beads_ = std::move(fine);
}

void BeadChain::thin() {
  for (std::size_t i = 1; i + 1 < beads_.size();) {
    if (freeTriangle(beads_[i - 1], beads_[i], beads_[i + 1])) {
      beads_.erase(beads_.begin() + static_cast<std::ptrdiff_t>(i));
      i = std::max<std::size_t>(i, 2) - 1;
    } else {
      ++i;
    }
  }
}

void BeadChain::moveAll() {
  for (const std::size_t block : {1U, 2U, 3U, 4U, 8U}) {
    for (std::size_t i = 1; i + block < beads_.size(); ++i) {
      while (moveBeads(i, i + block)) {
      }
    }
  }
}

void BeadChain::tighten() {
  thin();
  for (int round = 0; round < 60 && beads_.size() > 2; ++round) {
    const double before = length();
    moveAll();  // a few beads with long pieces between them: the chain slides along edges
    thin();
    subdivide();  // many with short ones: it lies round corners
    moveAll();
    thin();
    if (length() > before - kShorter) return;
  }
}

double BeadChain::length() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < beads_.size(); ++i) sum += (beads_[i] - beads_[i - 1]).norm();
  return sum;
}

}  // namespace

double pulledTight(const VoxelMap& map, const std::vector<Eigen::Vector3d>& line) {
  std::vector<Eigen::Vector3d> beads;
  for (const Eigen::Vector3d& p : line) beads.emplace_back((p - map.origin) / map.resolution);
  BeadChain chain(map, std::move(beads));
  chain.tighten();
  return chain.length() * map.resolution;
}

}  // namespace tautline::planning
