#include "sim_hil/real_time_server.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <span>

#include "common/clock.h"
#include "common/loop_timer.h"

namespace tautline::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kPeriod = milliseconds(2);
constexpr Duration kMaxCatchUp = milliseconds(100);
constexpr Duration kTruthPeriod = milliseconds(20);
constexpr Duration kParamsPeriod = seconds(10);

/// Telemetry that the terminal has not taken yet.
class Outbox {
 public:
  void flush(Simulator& simulator, ByteLink& link) noexcept {
    if (begin_ == end_) {
      begin_ = 0;
      end_ = simulator.transmit(buffer_);
    }
    begin_ += link.write(std::span(buffer_).subspan(begin_, end_ - begin_));
  }

 private:
  std::array<std::uint8_t, 4096> buffer_{};
  std::size_t begin_{0};
  std::size_t end_{0};
};

}  // namespace

ServerSummary serve(Simulator& simulator, ByteLink& link, TruthPublisher& publisher,
                    FaultInbox* faults, Duration duration, const volatile std::sig_atomic_t& stop) {
  ServerSummary summary;
  std::array<std::uint8_t, 4096> input{};
  Outbox outbox;
  const Duration unix_offset = unixOffset();
  const Time start = monotonicNow();
  Time wake = start;
  Time next_truth = start;
  Time next_params = start;
  bool had_client = false;
  while (stop == 0) {
    const Time now = monotonicNow();
    if (faults != nullptr) faults->poll(simulator);
    link.plug(!simulator.unplugged());
    for (std::size_t n = link.read(input); n > 0; n = link.read(input)) {
      simulator.receive(std::span(input).first(n));
      if (n < input.size()) break;
    }
    if (link.hasClient() && !had_client) ++summary.clients;
    had_client = link.hasClient();

    const Time wanted = Time{} + (now - start) - summary.time_lost;
    if (const Duration behind = wanted - simulator.now(); behind > kMaxCatchUp) {
      summary.time_lost += behind - kMaxCatchUp;
    }
    simulator.advanceTo(Time{} + (now - start) - summary.time_lost);
    outbox.flush(simulator, link);

    const std::int64_t utime = toMicroseconds(now + unix_offset);
    if (now >= next_truth) {
      publisher.publishTruth(simulator.truth(), utime);
      next_truth = std::max(next_truth + kTruthPeriod, now);
    }
    if (now >= next_params) {
      publisher.publishParams(utime);
      next_params = now + kParamsPeriod;
    }
    if (duration > Duration::zero() && simulator.now() >= Time{} + duration) break;
    wake += kPeriod;
    if (wake < now) wake = now + kPeriod;
    sleepUntil(wake);
  }
  summary.served = simulator.now() - Time{};
  return summary;
}

}  // namespace tautline::sim
