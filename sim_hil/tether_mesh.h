#pragma once

/// @file
/// How the chain's nodes lie on the tether's material. Without edges they are evenly spaced, and
/// pay-out is shared by all links. A link that is bent round an edge is kept centred on it by
/// moving the nodes along the material, so that the tether can slide round the edge without a node
/// passing it.

#include "sim_hil/tether_contact.h"

namespace tautline::sim {

class TetherMesh {
 public:
  explicit TetherMesh(int links) noexcept;

  /// Forgets all wishes for this step.
  void begin() noexcept;
  /// Wants the middle of `link` where the share `s` of it is now, with `extra` more of the whole
  /// length in it than an even share.
  void centre(int link, double s, double extra) noexcept;
  /// Moves the nodes for a step of h [s]. Real-time safe: no allocation, no locks, no exceptions.
  void update(double h) noexcept;

  /// Share of the whole length in a link.
  [[nodiscard]] double fraction(int link) const noexcept {
    return position_[at(link + 1)] - position_[at(link)];
  }
  /// Share of the whole length from the reel to a node.
  [[nodiscard]] double position(int node) const noexcept { return position_[at(node)]; }
  /// Its rate [1/s].
  [[nodiscard]] double rate(int node) const noexcept { return rate_[at(node)]; }

 private:
  static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }
  void wish(int node, double position) noexcept;

  int n_;
  NodeScalars position_{};
  NodeScalars rate_{};
  NodeScalars wish_{};   // sum of wishes
  NodeScalars count_{};  // how many
};

}  // namespace tautline::sim
