#pragma once

/// @file
/// How long work tells that it goes on, and is told to stop. Not real-time safe: offline only.

#include <atomic>
#include <functional>
#include <string_view>
#include <utility>

namespace tautline::planning {

/// Given to everything that may take over a second. Work asks `cancelled()` often (each few
/// thousand steps) and then returns the best it has; it calls `report()` about as often, from one
/// thread. Cancelling is safe from a signal handler and from any thread.
class Progress {
 public:
  /// What is being done, and how much of it is, 0 … 1; negative where nobody can know.
  using Report = std::function<void(std::string_view what, double fraction)>;

  Progress() = default;
  explicit Progress(Report report) : report_(std::move(report)) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void report(std::string_view what, double fraction) const {
    if (report_) report_(what, fraction);
  }
  [[nodiscard]] bool cancelled() const noexcept {
    return cancelled_.load(std::memory_order_relaxed);
  }
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }

 private:
  Report report_;
  std::atomic<bool> cancelled_{false};
};

}  // namespace tautline::planning
