#include "common/loop_timer.h"

#include <algorithm>
#include <ctime>

namespace tautline {

void sleepUntil(Time t) noexcept {
  const std::int64_t ns = t.time_since_epoch().count();
  timespec at{};
  at.tv_sec = static_cast<time_t>(ns / 1'000'000'000);
  at.tv_nsec = static_cast<long>(ns % 1'000'000'000);
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

void LoopStatistics::record(Duration lateness, Duration work,
                            std::int64_t skipped_periods) noexcept {
  const double lateness_s = toSeconds(lateness);
  const double work_s = toSeconds(work);
  ++totals_.cycles;
  ++window_cycles_;
  lateness_sum_ += lateness_s;
  work_sum_ += work_s;
  totals_.lateness_max = std::max(totals_.lateness_max, lateness_s);
  totals_.work_max = std::max(totals_.work_max, work_s);
  totals_.work_max_ever = std::max(totals_.work_max_ever, work_s);
  totals_.skipped_periods += skipped_periods;
  if (skipped_periods > 0) {
    ++totals_.overruns;
    totals_.missed_in_a_row += skipped_periods;
  } else {
    totals_.missed_in_a_row = 0;
  }
}

LoopStatistics::Snapshot LoopStatistics::snapshot() const noexcept {
  Snapshot out = totals_;
  if (window_cycles_ > 0) {
    out.lateness_mean = lateness_sum_ / static_cast<double>(window_cycles_);
    out.work_mean = work_sum_ / static_cast<double>(window_cycles_);
  }
  return out;
}

void LoopStatistics::startWindow() noexcept {
  totals_.lateness_max = 0.0;
  totals_.work_max = 0.0;
  lateness_sum_ = 0.0;
  work_sum_ = 0.0;
  window_cycles_ = 0;
}

}  // namespace tautline
