#include "app/cli/doctor/latency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/loop_timer.h"
#include "common/realtime.h"

namespace tautline::cli {

std::vector<Duration> measureLateness(Duration period, Duration length) {
  std::vector<Duration> lateness(
      static_cast<std::size_t>(std::max<std::int64_t>(length / period, 1)));
  std::thread loop([&] {
    // What is refused here is named by the checks of the rights.
    static_cast<void>(startRealTime(RealTimeConfig{}));
    TickGrid grid(period, monotonicNow() + period);
    for (Duration& late : lateness) {
      sleepUntil(grid.next());
      const Time now = monotonicNow();
      late = now - grid.next();
      grid.advance(now);
    }
  });
  loop.join();
  return lateness;
}

Duration quantile(const std::vector<Duration>& sorted, double q) {
  TAUTLINE_CHECK(!sorted.empty() && q > 0.0 && q <= 1.0);
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

std::string latencyHistogram(const std::vector<Duration>& lateness) {
  constexpr std::array kBounds_us{1,   2,    5,    10,   20,    50,    100,   200,
                                  500, 1000, 2000, 5000, 10000, 20000, 50000, 100000};
  constexpr std::size_t kWidth = 40;
  std::array<std::size_t, kBounds_us.size() + 1> counts{};
  for (const Duration late : lateness) {
    const auto* bound = std::find_if(kBounds_us.begin(), kBounds_us.end(),
                                     [&](int us) { return late <= std::chrono::microseconds(us); });
    ++counts[static_cast<std::size_t>(bound - kBounds_us.begin())];
  }
  const auto some = [](std::size_t n) { return n > 0; };
  const auto first = std::find_if(counts.begin(), counts.end(), some) - counts.begin();
  const auto last = counts.rend() - std::find_if(counts.rbegin(), counts.rend(), some);
  const std::size_t most =
      std::max<std::size_t>(*std::max_element(counts.begin(), counts.end()), 1);
  std::string text;
  for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
    const std::string bound =
        i < kBounds_us.size() ? fmt::format("<= {:6d} us", kBounds_us[i]) : "     beyond  ";
    text += fmt::format("  {} {:7d} {:#<{}}\n", bound, counts[i], "",
                        (counts[i] * kWidth + most - 1) / most);
  }
  return text;
}

}  // namespace tautline::cli
