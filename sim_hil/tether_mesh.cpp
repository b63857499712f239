#include "sim_hil/tether_mesh.h"

#include <algorithm>
#include <cmath>

namespace tautline::sim {
namespace {

constexpr double kSpreadTime = 0.1;     // of nodes without a wish [s]
constexpr double kSteeringTime = 0.05;  // of nodes with one [s]
constexpr double kEvenEnough = 1e-7;    // of the whole length
constexpr double kMinSpacing = 0.1;     // of nodes, relative to even spacing

}  // namespace

TetherMesh::TetherMesh(int links) noexcept : n_(links) {
  for (int k = 0; k <= n_; ++k) position_[at(k)] = static_cast<double>(k) / n_;
}

void TetherMesh::begin() noexcept {
  wish_.fill(0.0);
  count_.fill(0.0);
}

void TetherMesh::wish(int node, double position) noexcept {
  if (node <= 0 || node >= n_) return;
  wish_[at(node)] += position;
  count_[at(node)] += 1.0;
}

void TetherMesh::centre(int link, double s, double extra) noexcept {
  const double middle = position(link) + s * fraction(link);
  const double half = 0.5 * (1.0 / n_ + extra);
  wish(link, middle - half);
  wish(link + 1, middle + half);
}

void TetherMesh::update(double h) noexcept {
  const NodeScalars before = position_;
  const double steer = std::fmin(1.0, h / kSteeringTime);
  const double spread = std::fmin(1.0, h / kSpreadTime);
  int last = 0;  // node that has a place of its own
  for (int next = 1; next <= n_; ++next) {
    if (next < n_ && count_[at(next)] == 0.0) continue;
    if (next < n_) {
      const double target = wish_[at(next)] / count_[at(next)];
      position_[at(next)] += steer * (target - position_[at(next)]);
    }
    for (int k = last + 1; k < next; ++k) {
      const double even =
          position(last) + (position(next) - position(last)) * (k - last) / (next - last);
      const double off = even - position_[at(k)];
      if (std::abs(off) > kEvenEnough) position_[at(k)] += spread * off;
    }
    last = next;
  }
  const double gap = kMinSpacing / n_;
  for (int k = 1; k < n_; ++k) {
    position_[at(k)] =
        std::clamp(position_[at(k)], position_[at(k - 1)] + gap, 1.0 - (n_ - k) * gap);
    rate_[at(k)] = (position_[at(k)] - before[at(k)]) / h;
  }
}

}  // namespace tautline::sim
