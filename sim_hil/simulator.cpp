#include "sim_hil/simulator.h"

#include <algorithm>

#include "sim_hil/dispersion.h"
#include "sim_hil/fotokite_emulator.h"
#include "sim_hil/frame_faults.h"
#include "sim_hil/link_faults.h"
#include "sim_hil/plant.h"
#include "sim_hil/tautline_emulator.h"
#include "sim_hil/tautline_wire.h"

namespace tautline::sim {

namespace {

SimConfig effective(SimConfig config) {
  if (config.device != SimDevice::kFotokite) config.reel.metres_per_count = bus::kCountUnit;
  return config;
}

Wire wireOf(SimDevice device) noexcept {
  return device == SimDevice::kTautlineSlcan ? Wire::kSlcan
         : device == SimDevice::kTautlineCan ? Wire::kCanFrame
                                             : Wire::kCobs;
}

/// The emulated devices behind bytes, whatever they are.
class Machine {
 public:
  virtual ~Machine() = default;
  virtual void advance() noexcept = 0;
  virtual void receive(std::span<const std::uint8_t> bytes) noexcept = 0;
  virtual std::size_t transmit(std::span<std::uint8_t> out) noexcept = 0;
};

class FotokiteMachine final : public Machine {
 public:
  FotokiteMachine(const SimConfig& config, Plant& plant) : device_(config.fotokite, plant) {}
  void advance() noexcept override { device_.advance(); }
  void receive(std::span<const std::uint8_t> bytes) noexcept override { device_.receive(bytes); }
  std::size_t transmit(std::span<std::uint8_t> out) noexcept override {
    return device_.transmit(out);
  }

 private:
  FotokiteEmulator device_;
};

class TautlineMachine final : public Machine {
 public:
  TautlineMachine(const SimConfig& config, Plant& plant)
      : wire_(wireOf(config.device)),
        parser_(wire_),
        devices_(config.tautline, plant),
        faults_(plant.faults()) {}
  void advance() noexcept override { devices_.advance(); }
  void receive(std::span<const std::uint8_t> bytes) noexcept override {
    parser_.push(
        bytes, [this](const TautlineFrame& frame) { devices_.receive(frame); },
        [this](std::span<const std::uint8_t> reply) {
          for (const std::uint8_t byte : reply) replies_.put(byte);
        });
  }
  /// Answers first; messages whole, as many as fit.
  std::size_t transmit(std::span<std::uint8_t> out) noexcept override {
    std::size_t size = append(replies_, out, 0);
    replies_.size = 0;
    while (out.size() - size >= sizeof(WireBytes::buffer)) {
      if (passed_.empty()) {
        TautlineFrame frame;
        if (!devices_.transmit(frame)) break;
        passed_ = frame_faults_.pass(frame, faults_);
        continue;
      }
      size += append(encodeFrame(wire_, passed_.take()), out, size);
    }
    return size;
  }

 private:
  static std::size_t append(const WireBytes& bytes, std::span<std::uint8_t> out,
                            std::size_t at) noexcept {
    const std::size_t count = std::min(bytes.size, out.size() - at);
    std::copy_n(bytes.buffer.begin(), count, out.begin() + static_cast<std::ptrdiff_t>(at));
    return count;
  }

  Wire wire_;
  WireParser parser_;
  TautlineEmulator devices_;
  FaultSchedule& faults_;
  FrameFaults frame_faults_;
  FrameFaults::Result passed_;  // not yet taken
  WireBytes replies_;
};

std::unique_ptr<Machine> makeMachine(const SimConfig& config, Plant& plant) {
  if (config.device == SimDevice::kFotokite)
    return std::make_unique<FotokiteMachine>(config, plant);
  return std::make_unique<TautlineMachine>(config, plant);
}

}  // namespace

/// Everything but the constructor: real-time safe: no allocation, no locks, no exceptions.
struct Simulator::Impl {
  Impl(const SimConfig& config, const Scene& world, std::uint64_t seed)
      : plant(effective(config), world, seed), machine(makeMachine(config, plant)) {}

  /// Commands that were held back on the uplink reach the machine.
  void deliver() noexcept {
    if (!uplink.needed(plant.faults())) return;
    while (const std::size_t arrived = uplink.take(passing, plant.faults()))
      machine->receive(std::span(passing).first(arrived));
  }

  Plant plant;
  std::unique_ptr<Machine> machine;
  FaultyLink uplink{true};
  FaultyLink downlink{false};
  std::array<std::uint8_t, 4096> passing{};
};

Simulator::Simulator(const SimConfig& config, const Scene& world, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(dispersed(config, seed), world, seed)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

void Simulator::advanceTo(Time t) noexcept {
  while (impl_->plant.now() + impl_->plant.stepDuration() <= t) {
    impl_->plant.step();
    impl_->machine->advance();
  }
  impl_->deliver();
}

void Simulator::receive(std::span<const std::uint8_t> bytes) noexcept {
  if (!impl_->uplink.needed(impl_->plant.faults())) {
    impl_->machine->receive(bytes);
    return;
  }
  impl_->uplink.put(bytes, impl_->plant.faults());
  impl_->deliver();
}

std::size_t Simulator::transmit(std::span<std::uint8_t> out) noexcept {
  FaultSchedule& faults = impl_->plant.faults();
  if (!impl_->downlink.needed(faults)) return impl_->machine->transmit(out);
  while (const std::size_t sent = impl_->machine->transmit(impl_->passing))
    impl_->downlink.put(std::span(impl_->passing).first(sent), faults);
  return impl_->downlink.take(out, faults);
}

bool Simulator::inject(const Fault& fault) noexcept { return impl_->plant.faults().add(fault); }

bool Simulator::unplugged() const noexcept {
  return impl_->plant.faults().active(FaultTarget::kBus, FaultMode::kUnplug) != nullptr;
}

const Truth& Simulator::truth() const noexcept { return impl_->plant.truth(); }
Time Simulator::now() const noexcept { return impl_->plant.now(); }

}  // namespace tautline::sim
