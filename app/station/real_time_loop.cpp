#include "app/station/real_time_loop.h"

#include "common/clock.h"

namespace tautline {
namespace {

constexpr Duration kStatisticsPeriod = std::chrono::seconds(1);
constexpr int kParamsEvery = 10;  // statistics periods

}  // namespace

LoopStatistics::Snapshot realTimeLoop(const LoopParts& parts, Duration period,
                                      const volatile std::sig_atomic_t& stop) {
  LoopStatistics statistics;
  StepInput in;
  in.host = parts.host;
  in.host.clock_synchronized = clockSynchronized();
  TickGrid grid(period, monotonicNow() + period);
  Time next_statistics = grid.next();
  int until_params = 0;
  parts.telemetry.addRefusalsOf(parts.lcm.inbox().counts());

  while (stop == 0) {
    sleepUntil(grid.next());
    in.now = monotonicNow();  // the one reading of the clock that the core sees
    const Duration lateness = in.now - grid.next();

    in.host.lateness = lateness;
    in.host.unix_offset = unixOffset();
    if (parts.plugged != nullptr) in.host.device = parts.plugged->reality();

    parts.device.read(in.now, in.sensors);
    parts.lcm.poll(in.now, parts.station.lease().session);
    parts.lcm.inbox().fill(in);
    if (parts.lcm.recorder()) {
      in.host.recorder = parts.lcm.recorder();
      in.host.recorder->heard = in.now;
    }
    const StepOutput& out = parts.station.step(in);
    parts.device.write(in.now, out.command);
    parts.telemetry.publish(in, out);

    if (in.now >= next_statistics) {
      next_statistics += kStatisticsPeriod;
      parts.telemetry.publishLoop(in.now, period, statistics.snapshot());
      statistics.startWindow();
      in.host.clock_synchronized = clockSynchronized();
      if (until_params == 0) {
        parts.telemetry.publishParams(in.now);
        until_params = kParamsEvery;
      }
      --until_params;
    }

    const Time done = monotonicNow();
    const std::int64_t skipped = grid.advance(done);
    statistics.record(lateness, done - in.now, skipped);
    in.missed_in_a_row = static_cast<std::int32_t>(statistics.snapshot().missed_in_a_row);
    if (parts.service != nullptr) parts.service->cycleDone(done, skipped == 0);
    if (parts.black_box != nullptr)
      parts.black_box->record(makeRecord(in, out, lateness, done - in.now));
  }
  parts.device.shutdown(monotonicNow());
  if (parts.service != nullptr) parts.service->stopping();
  return statistics.snapshot();
}

}  // namespace tautline
