#pragma once

/// @file
/// Cost and heap use of the stages of a cycle, call by call. Benchmarks only.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/testing/malloc_guard.h"

namespace tautline::bench {

/// All calls of one stage.
class Stage {
 public:
  Stage(std::string name, std::size_t calls) : name_(std::move(name)) { cost_ns_.reserve(calls); }

  /// Runs `work` and keeps its time, less the clock's own, and its calls of the heap.
  template <class Work>
  void time(const Work& work) {
    const testing::MallocGuard guard;
    const Time begin = monotonicNow();
    work();
    const Time end = monotonicNow();
    heap_calls_ += guard.allocations() + guard.deallocations();
    add(end - begin);
  }

  /// One call that took `elapsed` on the clock.
  void add(Duration elapsed) {
    cost_ns_.push_back(
        static_cast<double>(std::max((elapsed - clockCost()).count(), Duration::rep{0})));
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] long heapCalls() const { return heap_calls_; }
  [[nodiscard]] std::size_t calls() const { return cost_ns_.size(); }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double ns : cost_ns_) sum += ns;
    return sum / static_cast<double>(cost_ns_.size());
  }
  /// [ns], nearest rank.
  [[nodiscard]] double quantile(double q) const {
    std::vector<double> sorted = cost_ns_;
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
    const auto nth =
        sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(sorted.begin(), nth, sorted.end());
    return *nth;
  }

  /// What two readings of the clock with nothing between them differ by (median of many).
  [[nodiscard]] static Duration clockCost() {
    static const Duration cost = [] {
      std::vector<Duration> pairs(1001);
      for (Duration& pair : pairs) {
        const Time begin = monotonicNow();
        pair = monotonicNow() - begin;
      }
      std::nth_element(pairs.begin(), pairs.begin() + 500, pairs.end());
      return pairs[500];
    }();
    return cost;
  }

 private:
  std::string name_;
  std::vector<double> cost_ns_;
  long heap_calls_{0};
};

}  // namespace tautline::bench
