#include "sim_hil/tether_mesh.h"

#include <algorithm>
#include <cmath>

namespace tautline::sim {
namespace {

constexpr int kFirstEdge = 100;          // features below are faces (obstacles.h)
constexpr double kAtNode = 0.004;        // nearer than this a node rests on the edge [m]
constexpr double kSteeringTime = 0.1;    // [s]
constexpr double kSlideGain = 0.5;       // part of the tension difference removed in one step
constexpr double kMinSpacing = 0.1;      // of nodes, relative to even spacing

}  // namespace

TetherMesh::TetherMesh(int links) noexcept : n_(links) {
  for (int k = 0; k <= n_; ++k) position_[at(k)] = static_cast<double>(k) / n_;
}

int TetherMesh::nodeAt(const TetherContact& c, double L) const noexcept {
  if (c.feature < kFirstEdge) return -1;
  const double length = fraction(c.link) * L;
  if (c.s * length < kAtNode && c.link > 0) return c.link;
  if ((1.0 - c.s) * length < kAtNode && c.link + 1 < n_) return c.link + 1;
  return -1;
}

void TetherMesh::update(double h, const State& state) noexcept {
  const NodeScalars before = position_;
  fixNodes(state);
  slide(state);
  spreadOthers(h);
  for (int k = 0; k <= n_; ++k) rate_[at(k)] = (position_[at(k)] - before[at(k)]) / h;
}

/// Gives each edge a node of its own: the one that rests there, or the nearer free end of the link.
void TetherMesh::fixNodes(const State& state) noexcept {
  fixed_.fill(false);
  slides_.fill(false);
  fixed_[0] = fixed_[at(n_)] = true;
  for (const TetherContact& c : state.contacts) {
    const int k = nodeAt(c, state.L_old);
    if (k < 0) continue;
    fixed_[at(k)] = slides_[at(k)] = true;
  }
  for (const TetherContact& c : state.contacts) {
    if (c.feature < kFirstEdge || nodeAt(c, state.L_old) >= 0) continue;
    int k = c.s < 0.5 ? c.link : c.link + 1;
    if (fixed_[at(k)]) k = c.s < 0.5 ? c.link + 1 : c.link;
    if (fixed_[at(k)]) continue;
    fixed_[at(k)] = true;
    target_[at(k)] = position(c.link) + c.s * fraction(c.link);
  }
}

/// Pay-out stays on the reel's side of an edge until the tensions pull it round.
void TetherMesh::slide(const State& state) noexcept {
  int before = 0;
  for (int k = 1; k < n_; ++k) {
    if (!fixed_[at(k)]) continue;
    if (!slides_[at(k)]) {
      before = k;
      continue;
    }
    int after = k + 1;
    while (!fixed_[at(after)]) ++after;
    double beyond = (1.0 - position(k)) * state.L_old;  // unstretched length to the drone
    const double reel_side = std::fmax((position(k) - position(before)) * state.L_old, kAtNode);
    const double drone_side = std::fmax((position(after) - position(k)) * state.L_old, kAtNode);
    const double T_reel = (*state.tension)[at(k - 1)];
    const double T_drone = (*state.tension)[at(k)];
    const double ratio = std::exp(state.friction * (*state.turn)[at(k)]);
    const double k_reel = state.stiffness / reel_side;
    const double k_drone = state.stiffness / drone_side;
    if (T_drone > ratio * T_reel) {
      beyond += kSlideGain * (T_drone - ratio * T_reel) / (k_drone + ratio * k_reel);
    } else if (T_reel > ratio * T_drone) {
      beyond -= kSlideGain * (T_reel - ratio * T_drone) / (k_reel + ratio * k_drone);
    }
    const double gap = kMinSpacing / n_;
    position_[at(k)] = std::clamp(1.0 - beyond / state.L, position(before) + (k - before) * gap,
                                  position(after) - (after - k) * gap);
    before = k;
  }
}

/// Steers the fixed nodes that are not there yet, and spreads the others evenly between fixed ones.
void TetherMesh::spreadOthers(double h) noexcept {
  const double part = std::fmin(1.0, h / kSteeringTime);
  for (int k = 1; k < n_; ++k) {
    if (fixed_[at(k)] && !slides_[at(k)]) {
      position_[at(k)] += part * (target_[at(k)] - position_[at(k)]);
    }
  }
  int before = 0;
  for (int after = 1; after <= n_; ++after) {
    if (!fixed_[at(after)]) continue;
    for (int k = before + 1; k < after; ++k) {
      const double even = position(before) + (position(after) - position(before)) * (k - before) /
                                                 (after - before);
      position_[at(k)] += part * (even - position_[at(k)]);
    }
    before = after;
  }
}

}  // namespace tautline::sim
