#include "planning_offline/field/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace tautline::planning {

bool parallelFor(int count, int threads, const Progress& progress, const Stage& stage,
                 const std::function<void(int)>& body) {
  std::atomic<int> next{0};
  const auto work = [&](bool reports) noexcept {
    for (int i = next++; i < count && !progress.cancelled(); i = next++) {
      body(i);
      if (reports) {
        const double done = std::min(next.load(), count) / static_cast<double>(count);
        progress.report(stage.what, stage.from + done * (stage.to - stage.from));
      }
    }
  };
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int wanted = std::min(threads > 0 ? threads : cores, count);
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < wanted; ++t) helpers.emplace_back(work, false);
    work(true);
  }
  return !progress.cancelled();
}

}  // namespace tautline::planning
