#pragma once

/// @file
/// When a search has to stop before it is done: time, labels, or the user. Not real-time safe:
/// offline only.

#include <chrono>
#include <cstdint>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

class Budget {
 public:
  Budget(const PlanOptions& options, const Progress& progress)
      : labels_(options.label_limit),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(options.time_limit))),
        progress_(&progress) {}

  /// True once `labels` are too many, time is over or the user cancelled. Asks clock and user every
  /// 256th call only, the first included, and tells `what` is going on.
  [[nodiscard]] bool spent(std::int64_t labels, const char* what) {
    if (reason_ != nullptr) return true;
    if (labels >= labels_) {
      reason_ = "label limit";
    } else if (calls_++ % 256 == 0) {
      progress_->report(what, -1.0);
      if (progress_->cancelled()) {
        reason_ = "cancelled";
      } else if (Clock::now() >= end_) {
        reason_ = "time limit";
      }
    }
    return reason_ != nullptr;
  }

  /// What was spent; null as long as nothing was.
  [[nodiscard]] const char* reason() const noexcept { return reason_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::int64_t labels_;
  Clock::time_point end_;
  const Progress* progress_;
  std::uint64_t calls_{0};
  const char* reason_{nullptr};
};

}  // namespace tautline::planning
