#include "control/contact_stack.h"

namespace tautline {

void ContactStack::clear() noexcept {
  entries_[0] = Entry{};
  size_ = 1;
}

ContactStack::Change ContactStack::select(int id, const MissionPlan& plan) noexcept {
  for (int i = size_ - 1; i >= 0; --i) {
    if (entries_[static_cast<std::size_t>(i)].id != id) continue;
    const Change change = i == size_ - 1 ? Change::kNone : Change::kPopped;
    size_ = i + 1;
    return change;
  }
  const MissionContact* contact = plan.findContact(id);
  return contact != nullptr ? push(id, contact->p_WC) : Change::kUnknownId;
}

ContactStack::Change ContactStack::push(int id, const Eigen::Vector3d& p_WC) noexcept {
  if (!p_WC.allFinite()) return Change::kBadPoint;
  if (size_ == static_cast<int>(entries_.size())) return Change::kFull;
  entries_[static_cast<std::size_t>(size_)] = {
      .id = id, .p_WC = p_WC, .L_static = top().L_static + (p_WC - top().p_WC).norm()};
  ++size_;
  return Change::kPushed;
}

Anchor ContactStack::anchor() const noexcept {
  return {.p_WA = top().p_WC, .L_static = top().L_static, .contact_count = contactCount()};
}

EffectiveControls ContactStack::effective(const Eigen::Vector3d& p_WD) const noexcept {
  EffectiveControls out;
  out.L_static = top().L_static;
  out.q = toTether(p_WD - top().p_WC);
  out.L_total = out.L_static + out.q.L;
  return out;
}

}  // namespace tautline
