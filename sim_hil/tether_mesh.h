#pragma once

/// @file
/// How the chain's nodes lie on the tether's material. Without contacts they are evenly spaced, and
/// pay-out is shared by all links. Where the tether bends over an edge, the nearest node is steered
/// to that edge; then the bend is where the edge is, whatever the size of the links, and the material
/// slides through that node by the capstan law: the tensions on its two sides differ at most by the
/// factor exp(mu * turn angle).

#include <span>

#include "sim_hil/tether_contact.h"

namespace tautline::sim {

class TetherMesh {
 public:
  explicit TetherMesh(int links) noexcept;

  /// Material state of the chain at the end of the last step.
  struct State {
    double L_old{0.0};  ///< Unstretched length before ...
    double L{0.0};      ///< ... and after this step's pay-out [m].
    double stiffness{1e4};  ///< EA [N]
    double friction{0.3};
    std::span<const TetherContact> contacts;
    const NodeScalars* tension{nullptr};  ///< Of each link [N].
    const NodeScalars* turn{nullptr};     ///< Angle between the links at each node [rad].
  };

  /// Moves the nodes for a step of h [s]. Real-time safe: no allocation, no locks, no exceptions.
  void update(double h, const State& state) noexcept;

  /// Share of the whole length in a link.
  [[nodiscard]] double fraction(int link) const noexcept {
    return position_[at(link + 1)] - position_[at(link)];
  }
  /// Share of the whole length from the reel to a node.
  [[nodiscard]] double position(int node) const noexcept { return position_[at(node)]; }
  /// Its rate [1/s].
  [[nodiscard]] double rate(int node) const noexcept { return rate_[at(node)]; }

  /// The node that rests on the edge of this contact, or -1.
  [[nodiscard]] int nodeAt(const TetherContact& contact, double L) const noexcept;

 private:
  static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }
  void fixNodes(const State& state) noexcept;
  void slide(const State& state) noexcept;
  void spreadOthers(double h) noexcept;

  int n_;
  NodeScalars position_{};
  NodeScalars rate_{};
  std::array<bool, kMaxLinks + 1> fixed_{};   // by an edge, and both ends
  std::array<bool, kMaxLinks + 1> slides_{};  // rests on its edge
  NodeScalars target_{};                      // of a fixed node
};

}  // namespace tautline::sim
