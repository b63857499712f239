// Cost of one cycle of the station, stage by stage, and its calls of the heap: a recorded flight is
// stepped again. Beside the station itself run the parts that it is made of, with the same inputs;
// that they say the same as the station in every cycle is checked, so that what is timed is what
// flies. Exit code 1 if they do not, or if the heap is used. The device is a real driver on a real
// pseudo terminal, telemetry goes through real LCM; as a reference as many bytes are sent once more
// by the kernel alone.

#include <arpa/inet.h>
#include <fcntl.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/bench/benchmark/recorded_flight.h"
#include "app/bench/benchmark/stopwatch.h"
#include "app/station/black_box.h"
#include "app/station/lcm_link.h"
#include "common/error.h"
#include "common/loop_timer.h"
#include "common/multicast.h"
#include "common/realtime.h"
#include "drivers/serial_port.h"

namespace tautline::bench {
namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:7685?ttl=0";
/// Between two cycles: the kernel carries the bytes over, and each cycle begins out of a sleep.
constexpr Duration kPause = std::chrono::microseconds(300);

/// Counts instead of sending, where this machine has no multicast route.
class NullSink final : public TelemetrySink {
 public:
  bool publish(const char*, std::int64_t, std::span<const std::uint8_t>) noexcept override {
    return true;
  }
};

/// What LCM does at the least: a datagram to a group that a thread of this process listens to, as
/// LCM's own does, for the station hears its own messages.
class BareMulticast {
 public:
  BareMulticast() {
    address_.sin_family = AF_INET;
    address_.sin_port = htons(7686);
    inet_pton(AF_INET, "239.255.76.67", &address_.sin_addr);
    const ip_mreq group{.imr_multiaddr = address_.sin_addr, .imr_interface = {INADDR_ANY}};
    const int yes = 1;
    setsockopt(in_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    const timeval patience{.tv_sec = 0, .tv_usec = 200'000};
    setsockopt(in_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (bind(in_, to(), sizeof address_) != 0 ||
        setsockopt(in_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0) {
      throw InputError({.key = "multicast", .problem = std::strerror(errno)}, ExitCode::kTimeout);
    }
    const unsigned char ttl = 0;
    setsockopt(out_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
    reader_ = std::thread([this] {
      std::array<std::uint8_t, 65536> heard{};
      while (!ends_) static_cast<void>(recv(in_, heard.data(), heard.size(), 0));
    });
  }
  ~BareMulticast() {
    ends_ = true;
    reader_.join();
    close(in_);
    close(out_);
  }
  BareMulticast(const BareMulticast&) = delete;
  BareMulticast& operator=(const BareMulticast&) = delete;

  void send(std::size_t size) noexcept {
    static_cast<void>(
        sendto(out_, nothing_.data(), std::min(size, nothing_.size()), 0, to(), sizeof address_));
  }

 private:
  [[nodiscard]] const sockaddr* to() const noexcept {
    return reinterpret_cast<const sockaddr*>(&address_);
  }

  int in_{socket(AF_INET, SOCK_DGRAM, 0)};
  int out_{socket(AF_INET, SOCK_DGRAM, 0)};
  sockaddr_in address_{};
  std::array<std::uint8_t, 32768> nothing_{};
  std::atomic<bool> ends_{false};
  std::thread reader_;
};

/// What a cycle sends, timed as one, and as much once more by the kernel alone.
class TimedSink final : public TelemetrySink {
 public:
  explicit TimedSink(TelemetrySink& inner) : inner_(inner) {}

  bool publish(const char* channel, std::int64_t utime,
               std::span<const std::uint8_t> bytes) noexcept override {
    const Time begin = monotonicNow();
    const bool ok = inner_.publish(channel, utime, bytes);
    sent_ += monotonicNow() - begin - Stage::clockCost();
    if (count_ < sizes_.size()) sizes_[count_++] = kLcmHeader + std::strlen(channel) + bytes.size();
    return ok;
  }
  void endCycle(BareMulticast& bare, Stage& by_lcm, Stage& by_kernel) {
    by_lcm.add(sent_ + Stage::clockCost());
    sleepUntil(monotonicNow() + kPause);
    const Time begin = monotonicNow();
    for (std::size_t i = 0; i < count_; ++i) bare.send(sizes_[i]);
    by_kernel.add(monotonicNow() - begin);
    sent_ = {};
    count_ = 0;
  }

 private:
  static constexpr std::size_t kLcmHeader = 9;  // magic, sequence, the channel's terminator
  TelemetrySink& inner_;
  Duration sent_{};
  std::array<std::size_t, 64> sizes_{};
  std::size_t count_{0};
};

/// The simulated machine at the far end of a pseudo terminal, moved along by hand.
class Cable {
 public:
  explicit Cable(const LockstepConfig& config) : simulator_(config.sim, config.world, config.seed) {
    int slave = -1;
    TAUTLINE_CHECK(openpty(&master_, &slave, nullptr, nullptr, nullptr) == 0);
    fcntl(master_, F_SETFL, O_NONBLOCK);
    TAUTLINE_CHECK(static_cast<bool>(port_.adopt(slave)));
  }
  ~Cable() { close(master_); }
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  void advanceTo(Time now) {
    std::array<std::uint8_t, 4096> buffer{};
    if (const ssize_t size = ::read(master_, buffer.data(), buffer.size()); size > 0)
      simulator_.receive({buffer.data(), static_cast<std::size_t>(size)});
    simulator_.advanceTo(now);
    const std::size_t size = simulator_.transmit(buffer);
    TAUTLINE_CHECK(::write(master_, buffer.data(), size) == static_cast<ssize_t>(size));
  }
  [[nodiscard]] SerialPort& port() { return port_; }

 private:
  sim::Simulator simulator_;
  SerialPort port_{SerialConfig{.device = ""}};
  int master_{-1};
};

struct Stages {
  explicit Stages(std::size_t calls)
      : all{Stage("device read", calls),
            Stage("LCM poll", calls),
            Stage("station step, of which", calls),
            Stage("  estimate", calls),
            Stage("  supervise", calls),
            Stage("  guidance, executor", calls),
            Stage("  control", calls),
            Stage("  gate, dead zone", calls),
            Stage("command encode, write", calls),
            Stage("telemetry, of which", calls),
            Stage("  LCM publish", calls),
            Stage("black box", calls),
            Stage("whole cycle", calls),
            Stage("reference: bare multicast", calls)} {}
  enum Index {
    kRead,
    kPoll,
    kStep,
    kEstimate,
    kSupervise,
    kGuidance,
    kControl,
    kGate,
    kWrite,
    kTelemetry,
    kPublish,
    kBlackBox,
    kCycle,
    kBareSend
  };
  Stage& operator[](Index i) { return all[i]; }
  std::array<Stage, 14> all;
};

/// The parts of the core once more, fed as the station feeds its own.
class Shadow {
 public:
  Shadow(const CoreConfig& config, const MissionPlan& plan)
      : config_(config),
        plan_(plan),
        localizer_(config.localizer),
        supervisor_(config.supervisor),
        guidance_(config_.guidance, config_.executor, config_.control.composite.pole,
                  config_.limits),
        controller_(makeController(config_.control)),
        dead_zone_(config_.reel_dead_zone),
        gate_(config_.gate, config_.limits) {}

  /// The same cycle as the station's, whose output is `out`; false if they differ.
  bool step(const StepInput& in, const StepOutput& out, Stages& stages) {
    const Duration dt = last_ ? in.now - *last_ : Duration::zero();
    if (!last_) localizer_.reset(config_.guidance.home_position_m, in.now);
    last_ = in.now;
    Estimate estimate;
    stages[Stages::kEstimate].time(
        [&] { estimate = localizer_.update(in.now, in.sensors, last_command_, out.anchor); });
    const Request request = in.command && out.ack && out.ack->result == AckResult::kAccepted
                                ? in.command->request
                                : Request::kNone;
    SupervisorOutput supervision;
    stages[Stages::kSupervise].time(
        [&] { supervision = supervisor_.step(in.now, out.conditions, request); });
    if (supervision.changed && supervision.mode == Mode::kStandby) {
      localizer_.reset(config_.guidance.home_position_m, in.now);
      controller_->reset();
      dead_zone_.reset();
    }
    GuidanceOutput guidance;
    stages[Stages::kGuidance].time([&] {
      guidance = guidance_.update({.now = in.now,
                                   .dt = dt,
                                   .mode = supervision.mode,
                                   .entered = supervision.changed,
                                   .estimate = estimate,
                                   .vehicle = in.sensors.vehicle.value.phase,
                                   .sensors = &in.sensors,
                                   .plan = &plan_,
                                   .conditions = out.conditions});
    });
    VehicleCommand wanted = guidance.command;
    if (guidance.route.active) {
      RateCommand rates;
      stages[Stages::kControl].time(
          [&] { rates = controller_->update(dt, guidance.route.control); });
      wanted.length_rate = rates.length_rate;
      wanted.elevation_rate = rates.elevation_rate;
      wanted.azimuth_rate = rates.azimuth_rate;
    }
    stages[Stages::kGate].time([&] {
      VehicleCommand gated = gate_.apply(dt, wanted).command;
      gated.length_rate = dead_zone_.compensate(dt, gated.length_rate);
    });
    last_command_ = out.command;
    return estimate.p_WD == out.estimate.p_WD && supervision.mode == out.supervision.mode &&
           guidance_.mission().state == out.mission.state &&
           guidance_.mission().waypoint == out.mission.waypoint;
  }

 private:
  CoreConfig config_;
  const MissionPlan& plan_;
  Localizer localizer_;
  Supervisor supervisor_;
  Guidance guidance_;
  std::unique_ptr<Controller> controller_;
  ReelDeadZone dead_zone_;
  CommandGate gate_;
  std::optional<Time> last_;
  VehicleCommand last_command_;
};

/// What the loop does in a cycle, in its order, for every cycle of the flight; false if the parts
/// disagree with the station.
bool stepAgain(const RecordedFlight& flight, TimedSink& sink, LcmLink* lcm, BareMulticast* bare,
               Stages& stages) {
  const StationConfig& config = flight.config.station;
  const auto station = std::make_unique<Station>(config.core);
  const auto shadow = std::make_unique<Shadow>(config.core, *flight.mission.plan);
  Cable cable(flight.config);
  FotokiteDevice device(cable.port(), config.fotokite);
  Telemetry telemetry(sink, RunMode::kSim, Duration::zero(),
                      fromSeconds(1.0 / config.telemetry_rate_hz));
  const auto path =
      std::filesystem::path("/dev/shm") / ("tautline_cycle_benchmark_" + std::to_string(getpid()));
  BlackBox black_box(path);
  SensorFrame frame;
  bool same = true;
  for (const StepInput& in : flight.cycles) {
    cable.advanceTo(in.now);
    sleepUntil(monotonicNow() + kPause);
    const StepOutput* out = nullptr;
    const Time begin = monotonicNow();
    stages[Stages::kRead].time([&] { device.read(in.now, frame); });
    if (lcm != nullptr) stages[Stages::kPoll].time([&] { lcm->poll(in.now, 0); });
    stages[Stages::kStep].time([&] { out = &station->step(in); });
    stages[Stages::kWrite].time([&] { device.write(in.now, out->command); });
    stages[Stages::kTelemetry].time([&] { telemetry.publish(in, *out); });
    stages[Stages::kBlackBox].time([&] { black_box.record(makeRecord(in, *out, {}, {})); });
    stages[Stages::kCycle].add(monotonicNow() - begin);
    same = shadow->step(in, *out, stages) && same;
    if (bare != nullptr) sink.endCycle(*bare, stages[Stages::kPublish], stages[Stages::kBareSend]);
  }
  std::filesystem::remove(path);
  return same;
}

void printTable(const Stages& stages) {
  std::printf("%-26s %8s %8s %8s %8s %9s %6s\n", "stage [ns]", "calls", "mean", "p50", "p99",
              "p99.9", "heap");
  for (const Stage& s : stages.all) {
    if (s.calls() == 0) continue;
    std::printf("%-26s %8zu %8.0f %8.0f %8.0f %9.0f %6ld\n", s.name().c_str(), s.calls(), s.mean(),
                s.quantile(0.5), s.quantile(0.99), s.quantile(0.999), s.heapCalls());
  }
}

int run() {
  const RecordedFlight flight = recordFlight(std::filesystem::path(TAUTLINE_SOURCE_DIR) / "config",
                                             "two_contacts", "two_contacts");
  std::unique_ptr<LcmLink> lcm;
  std::unique_ptr<BareMulticast> bare;  // its reader, as LCM's, before there is real time
  NullSink null;
  if (hasMulticastRoute(kUrl)) {
    lcm = std::make_unique<LcmLink>(kUrl);
    bare = std::make_unique<BareMulticast>();
  } else {
    std::printf("no multicast route: telemetry is encoded but not sent (./run rt makes a route)\n");
  }
  for (const RealTimeStep& step : startRealTime(RealTimeConfig{}))
    if (!step.ok) std::printf("not %s\n", step.name.c_str());
  TimedSink sink(lcm ? static_cast<TelemetrySink&>(*lcm) : null);
  // Once to warm caches, branch predictors and LCM's table of channels; once to measure.
  Stages warm_up(flight.cycles.size());
  bool same = stepAgain(flight, sink, lcm.get(), bare.get(), warm_up);
  Stages stages(flight.cycles.size());
  same = stepAgain(flight, sink, lcm.get(), bare.get(), stages) && same;
  std::printf("%zu cycles of a flight with two contacts; the clock's own %lld ns are taken off\n",
              flight.cycles.size(), static_cast<long long>(Stage::clockCost().count()));
  printTable(stages);
  long heap_calls = 0;
  for (const Stage& s : stages.all) heap_calls += s.heapCalls();
  if (!same) std::printf("error: the parts did not say the same as the station\n");
  if (heap_calls > 0) std::printf("error: the cycle uses the heap\n");
  return same && heap_calls == 0 ? 0 : 1;
}

}  // namespace
}  // namespace tautline::bench

int main() {
  try {
    return tautline::bench::run();
  } catch (...) {
    return tautline::reportException("cycle_benchmark");
  }
}
