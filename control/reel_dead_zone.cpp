#include "control/reel_dead_zone.h"

#include <algorithm>
#include <cmath>

namespace tautline {

void ReelDeadZone::reset() noexcept {
  owed_ = 0.0;
  output_ = 0.0;
  dwelt_ = 0.0;
  active_ = false;
}

double ReelDeadZone::compensate(Duration dt, double rate) noexcept {
  const double lo = config_.min_rate_mps;
  const double hi = config_.max_rate_mps;
  const bool inside = rate > lo && rate < hi;  // false for NaN
  if (!inside || rate == 0.0) {
    reset();
    return std::isfinite(rate) ? rate : 0.0;
  }
  // The rates that work, next below and above. Rest works everywhere; it is one of them if it lies
  // inside the band.
  const double slower = lo < 0.0 && hi > 0.0 && rate > 0.0 ? 0.0 : lo;
  const double faster = lo < 0.0 && hi > 0.0 && rate < 0.0 ? 0.0 : hi;
  const double seconds = std::max(0.0, toSeconds(dt));
  if (active_) {
    owed_ += (rate - output_) * seconds;
    dwelt_ += seconds;
  }
  if (!active_ || dwelt_ >= config_.dwell_s) {
    const bool want_more = active_ ? owed_ > 0.0 : rate > 0.5 * (slower + faster);
    const double next = want_more ? faster : slower;
    if (next != output_ || !active_) dwelt_ = 0.0;
    output_ = next;
    active_ = true;
  }
  return output_;
}

}  // namespace tautline
