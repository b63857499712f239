#include "supervision/detect/oscillation_watch.h"

#include <algorithm>
#include <cmath>

namespace tautline {

std::size_t OscillationWatch::samplesInWindow() const noexcept {
  return std::min(kRoom, static_cast<std::size_t>(config_.window_s / toSeconds(kSampling)));
}

void OscillationWatch::update(Time now, const std::optional<Eigen::Vector3d>& p_WD,
                              Findings& out) noexcept {
  if (!p_WD) {
    next_.reset();
    count_ = 0;
  } else if (!next_) {
    next_ = now + kSampling;
    slow_ = *p_WD;
    slower_.setZero();
  } else if (now >= *next_) {
    next_ = std::max(*next_ + kSampling, now);
    push(*p_WD);
  }
  judge(out);
}

/// The high pass twice: a steady speed leaves nothing, and a corner of the path one short swing.
void OscillationWatch::push(const Eigen::Vector3d& p) noexcept {
  const double gain = 1.0 - std::exp(-toSeconds(kSampling) / config_.high_pass_s);
  slow_ += gain * (p - slow_);
  const Eigen::Vector3d once = p - slow_;
  slower_ += gain * (once - slower_);
  fast_[count_++ % kRoom] = once - slower_;
}

/// (D5)
void OscillationWatch::judge(Findings& out) const noexcept {
  const std::size_t samples = samplesInWindow();
  double worst = 0.0;
  for (int axis = 0; axis < 3 && count_ >= samples; ++axis) {
    double squares = 0.0;
    int side = 0;
    int crossings = 0;
    for (std::size_t i = count_ - samples; i < count_; ++i) {
      const double x = fast_[i % kRoom][axis];
      squares += x * x;
      if (std::abs(x) < config_.swing_m) continue;
      const int now_on = x > 0.0 ? 1 : -1;
      if (side != 0 && now_on != side) ++crossings;
      side = now_on;
    }
    if (crossings >= config_.crossings)
      worst = std::max(worst, std::sqrt(squares / static_cast<double>(samples)));
  }
  out.reportAbove(Condition::kOscillation, worst, config_.rms_m);
}

}  // namespace tautline
