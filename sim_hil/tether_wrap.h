#pragma once

/// @file
/// The edges round which the tether is bent: when a bend forms, how it slides along its edge, and
/// when it comes off. Bends are ordered from reel to drone.

#include <span>

#include <Eigen/Core>

#include "sim_hil/obstacles.h"
#include "sim_hil/tether_contact.h"

namespace tautline::sim {

/// Real-time safe: no allocation, no locks, no exceptions.
class TetherWrap {
 public:
  [[nodiscard]] std::span<const EdgeContact> all() const noexcept {
    return {bend_.data(), static_cast<std::size_t>(count_)};
  }
  /// Those of one link.
  [[nodiscard]] std::span<const EdgeContact> on(int link) const noexcept;
  [[nodiscard]] bool touches(int link, int obstacle, const Obstacles& obstacles) const noexcept;

  /// A straight link at `x_j`, `x_k` has been found to overlap an edge: it is now bent round it.
  void add(const ConvexPrism& prism, int solid, int link, const SegmentContact& contact,
           const Eigen::Vector3d& x_j, const Eigen::Vector3d& x_k) noexcept;

  /// Slides bends along their edges where the tether pulls outside the friction cone; takes off
  /// those that would pull away from their solid or have reached the end of their edge; hands a
  /// bend to the next link when a node reaches it. `x` are the chain's nodes.
  void update(std::span<const Eigen::Vector3d> x, double friction) noexcept;

  /// Way of a bent link: points, length, directions at both ends and the sum of its turns.
  struct Way {
    double length{0.0};
    double first{0.0};  ///< Length of the first ...
    double last{0.0};   ///< ... and of the last straight part.
    Eigen::Vector3d t_first{Eigen::Vector3d::UnitZ()};
    Eigen::Vector3d t_last{Eigen::Vector3d::UnitZ()};
    double turn{0.0};
  };
  [[nodiscard]] static Way wayOf(std::span<const EdgeContact> bends, const Eigen::Vector3d& x_j,
                                 const Eigen::Vector3d& x_k) noexcept;

 private:
  void remove(int i) noexcept;
  void slide(EdgeContact& bend, const Eigen::Vector3d& before, const Eigen::Vector3d& after,
             double friction) const noexcept;

  std::array<EdgeContact, kMaxEdgeContacts> bend_{};
  int count_{0};
};

}  // namespace tautline::sim
