#pragma once

/// @file
/// What the strings have in common: their stacks are nodes of one tree. Not real-time safe: offline
/// only.

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/tether/contact_tree.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {

class TreeString : public TautString {
 public:
  [[nodiscard]] const Eigen::Vector3d& reel() const noexcept final { return reel_; }
  [[nodiscard]] Eigen::Vector3d anchor(StackId stack) const final { return tree_.point(stack); }
  [[nodiscard]] double staticLength(StackId stack) const final { return tree_.staticLength(stack); }
  [[nodiscard]] int contactCount(StackId stack) const final { return tree_.count(stack); }
  [[nodiscard]] std::vector<Eigen::Vector3d> contacts(StackId stack) const final {
    return tree_.contacts(stack);
  }
  [[nodiscard]] bool touchesForbidden(StackId stack) const final { return tree_.forbidden(stack); }

  /// Cells that the tether must not touch: said before the first move.
  void forbid(NoContactCells cells) { tree_.forbid(std::move(cells)); }

 protected:
  TreeString(const Eigen::Vector3d& reel, double grazing) : reel_(reel), tree_(reel, grazing) {}

  [[nodiscard]] ContactTree& tree() noexcept { return tree_; }
  [[nodiscard]] const ContactTree& tree() const noexcept { return tree_; }

 private:
  Eigen::Vector3d reel_;
  ContactTree tree_;
};

}  // namespace tautline::planning
