#include "sim_hil/reel_faults.h"

#include <algorithm>

namespace tautline::sim {
namespace {

constexpr Duration kRandomTurn = std::chrono::milliseconds(300);

}  // namespace

ReelDisturbance ReelFaults::step(double wanted, FaultSchedule& faults) noexcept {
  using M = FaultMode;
  const auto active = [&](M mode) { return faults.active(FaultTarget::kReel, mode); };
  const Time now = faults.now();
  double rate = wanted;
  history_.put(now, wanted);
  if (const Fault* f = active(M::kDelayed)) rate = history_.at(now - fromSeconds(f->value));
  if (active(M::kStuck) == nullptr) held_ = rate;
  rate = held_;
  if (const Fault* f = active(M::kWrong)) rate *= f->value;
  if (const Fault* f = active(M::kGarbage)) {
    if (now >= next_random_) {
      random_ = f->value * faults.random().signedUniform();
      next_random_ = now + kRandomTurn;
    }
    rate = random_;
  }
  if (const Fault* f = active(M::kSlow)) rate = std::clamp(rate, -f->value, f->value);
  if (const Fault* f = active(M::kSlack)) rate = f->value;
  if (contact_.open(active(M::kIntermittent), faults) || active(M::kOff) != nullptr) rate = 0.0;

  ReelDisturbance disturbance;
  if (rate != wanted) disturbance.rate = rate;
  if (const Fault* f = active(M::kPayoutSlip)) disturbance.follows = 1.0 - f->value;
  return disturbance;
}

}  // namespace tautline::sim
