#include "sim_hil/simulator.h"

#include <algorithm>

#include "sim_hil/fotokite_emulator.h"
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
      : wire_(wireOf(config.device)), parser_(wire_), devices_(config.tautline, plant) {}
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
    TautlineFrame frame;
    while (out.size() - size >= WireBytes{}.buffer.size() && devices_.transmit(frame))
      size += append(encodeFrame(wire_, frame), out, size);
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
  WireBytes replies_;
};

std::unique_ptr<Machine> makeMachine(const SimConfig& config, Plant& plant) {
  if (config.device == SimDevice::kFotokite)
    return std::make_unique<FotokiteMachine>(config, plant);
  return std::make_unique<TautlineMachine>(config, plant);
}

}  // namespace

struct Simulator::Impl {
  Impl(const SimConfig& config, const Scene& world, std::uint64_t seed)
      : plant(effective(config), world, seed), machine(makeMachine(config, plant)) {}

  Plant plant;
  std::unique_ptr<Machine> machine;
};

Simulator::Simulator(const SimConfig& config, const Scene& world, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(config, world, seed)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

void Simulator::advanceTo(Time t) noexcept {
  while (impl_->plant.now() + impl_->plant.stepDuration() <= t) {
    impl_->plant.step();
    impl_->machine->advance();
  }
}

void Simulator::receive(std::span<const std::uint8_t> bytes) noexcept {
  impl_->machine->receive(bytes);
}

std::size_t Simulator::transmit(std::span<std::uint8_t> out) noexcept {
  return impl_->machine->transmit(out);
}

const Truth& Simulator::truth() const noexcept { return impl_->plant.truth(); }
Time Simulator::now() const noexcept { return impl_->plant.now(); }

}  // namespace tautline::sim
