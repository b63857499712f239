#include "planning_offline/tether/pinned_string.h"

#include <cmath>

#include "common/error.h"
#include "planning_offline/field/reel_place.h"

namespace tautline::planning {
namespace {

constexpr double kQuantum = 0x1p-30;  // of a contact's place along its edge [cells]

}  // namespace

class PinnedString::Held {
 public:
  Held(PinnedString& string, StackId stack) : string_(string), stack_(stack) {}

  [[nodiscard]] StackId stack() const { return stack_; }
  [[nodiscard]] bool empty() const { return stack_ == kStraight; }
  [[nodiscard]] const Eigen::Vector3d& anchor() const { return string_.anchors_[stack_]; }
  [[nodiscard]] const Eigen::Vector3d& anchorBelow() const {
    return string_.anchors_[string_.tree().pop(stack_)];
  }
  [[nodiscard]] Bend last() const {
    const ContactKey& key = string_.tree().key(stack_);
    return {anchor(), ConvexEdge::unpacked(key.edge), key.turn};
  }
  void pop() { stack_ = string_.tree().pop(stack_); }
  void push(const Bend& bend) { stack_ = string_.push(stack_, bend); }

 private:
  PinnedString& string_;
  StackId stack_;
};

PinnedString::PinnedString(const VoxelMap& map, const Eigen::Vector3d& reel)
    : TreeString(checkedReel(map, reel), kGrazing * map.resolution),
      origin_(map.origin),
      resolution_(map.resolution),
      sweep_(map),
      anchors_{cellsOf(reel)} {}

Eigen::Vector3d PinnedString::cellsOf(const Eigen::Vector3d& p_M) const {
  const Eigen::Vector3d cells = (p_M - origin_) / resolution_;
  TAUTLINE_CHECK((cells.array().abs() <= kFarthest).all());
  return cells;
}

StackId PinnedString::push(StackId stack, const Bend& bend) {
  const StackId id = tree().push(stack,
                                 {.edge = bend.edge.packed(),
                                  .place = std::llround(bend.place() / kQuantum),
                                  .turn = bend.turn},
                                 origin_ + resolution_ * bend.onTrueEdge());
  if (id == anchors_.size()) anchors_.push_back(bend.at);
  return id;
}

std::optional<StackId> PinnedString::drag(StackId stack, const Eigen::Vector3d& x,
                                          const Eigen::Vector3d& q) {
  Held held(*this, stack);
  if (!sweep_.drag(held, x, q)) return std::nullopt;
  return held.stack();
}

bool PinnedString::free(StackId stack, const Eigen::Vector3d& end) {
  if (!sweep_.freeAfterDrag(anchors_[stack], end)) return false;
  for (StackId s = stack; s != kStraight; s = tree().pop(s)) {
    if (s < checked_.size() && checked_[s] != 0) break;
    if (!sweep_.free(anchors_[tree().pop(s)], anchors_[s])) return false;
  }
  if (stack >= checked_.size()) checked_.resize(stack + std::size_t{1}, 0);
  checked_[stack] = 1;
  return true;
}

StackId PinnedString::move(StackId stack, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d p = cellsOf(from);
  const Eigen::Vector3d q = cellsOf(to);
  const std::optional<StackId> direct = drag(stack, p, q);
  if (direct && free(*direct, q)) return *direct;
  for (const Eigen::Vector3d& aside : StringSweep::asides()) {
    const Eigen::Vector3d via = 0.5 * (p + q) + aside;
    const std::optional<StackId> half = drag(stack, p, via);
    const std::optional<StackId> whole = half ? drag(*half, via, q) : std::nullopt;
    if (whole && free(*whole, q)) return *whole;
  }
  ++unresolved_;
  return direct.value_or(stack);
}

}  // namespace tautline::planning
