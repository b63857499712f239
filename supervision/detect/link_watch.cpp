#include "supervision/detect/link_watch.h"

namespace tautline {

void LinkWatch::update(Time now, std::uint32_t good, std::uint32_t bad, Findings& out) noexcept {
  const Count count{now, good, bad};
  if (!start_) start_ = count;
  if (toSeconds(now - start_->time) >= config_.window_s) {
    const double bad_ones = bad - start_->bad;
    const double all = bad_ones + (good - start_->good);
    fraction_ = all >= config_.least_messages ? bad_ones / all : 0.0;
    start_ = count;
  }
  out.reportAbove(Condition::kCrcRate, fraction_, config_.bad_fraction);
}

}  // namespace tautline
