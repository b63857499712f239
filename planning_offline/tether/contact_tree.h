#pragma once

/// @file
/// Contact stacks as nodes of a tree: a stack is its last contact on top of the stack without it.
/// Stacks are interned, so two of them are equal if and only if their numbers are. Not real-time
/// safe: offline only.

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/tether/no_contact.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {

/// What makes two contacts of one stack the same.
struct ContactKey {
  std::uint64_t edge{0};  ///< ConvexEdge::packed().
  std::int64_t place{0};  ///< Along the edge, in the string's quantum; 0 in the plane.
  std::int32_t turn{0};   ///< +1 counter-clockwise about the edge's axis, −1 clockwise.
  friend bool operator==(const ContactKey&, const ContactKey&) = default;
};

/// Distance of p from the segment a – b.
[[nodiscard]] double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b) noexcept;

class ContactTree {
 public:
  /// `reel` in M [m]. A contact whose neighbours' chord passes it nearer than `grazing` [m] counts
  /// as straight: it stays on the stack, but is neither counted nor listed.
  ContactTree(const Eigen::Vector3d& reel, double grazing);

  /// Cells that no contact may touch; there must be no stack yet.
  void forbid(NoContactCells cells);

  /// The stack with one more contact, at `point` in M [m].
  [[nodiscard]] StackId push(StackId stack, const ContactKey& key, const Eigen::Vector3d& point);

  /// The stack without its last contact; not for kStraight.
  [[nodiscard]] StackId pop(StackId stack) const { return node(stack).parent; }
  /// The last contact; not for kStraight.
  [[nodiscard]] const ContactKey& key(StackId stack) const { return node(stack).key; }

  /// The last contact, or the reel.
  [[nodiscard]] const Eigen::Vector3d& point(StackId stack) const { return node(stack).point; }
  [[nodiscard]] double staticLength(StackId stack) const { return node(stack).static_length; }
  [[nodiscard]] int count(StackId stack) const { return node(stack).count; }
  /// Those that count, from the reel to the vehicle.
  [[nodiscard]] std::vector<Eigen::Vector3d> contacts(StackId stack) const;
  /// True if one of contacts() touches a forbidden cell.
  [[nodiscard]] bool forbidden(StackId stack) const { return node(stack).forbidden; }

 private:
  struct Node {
    StackId parent{kStraight};
    StackId listed{kStraight};  ///< Nearest stack below whose last contact counts under this one.
    int count{0};
    bool forbidden{false};  ///< One of those that count touches a forbidden cell.
    ContactKey key;
    Eigen::Vector3d point;
    double static_length{0.0};
  };
  struct Child {
    StackId parent;
    ContactKey key;
    friend bool operator==(const Child&, const Child&) = default;
  };
  struct ChildHash {
    [[nodiscard]] std::size_t operator()(const Child& child) const noexcept;
  };

  [[nodiscard]] const Node& node(StackId stack) const;

  double grazing_;
  NoContactCells no_contact_;
  std::vector<Node> nodes_;
  std::unordered_map<Child, StackId, ChildHash> children_;
};

}  // namespace tautline::planning
