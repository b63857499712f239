#include "sim_hil/simulator.h"

#include "sim_hil/fotokite_emulator.h"
#include "sim_hil/plant.h"

namespace tautline::sim {

struct Simulator::Impl {
  Impl(const SimConfig& config, const Scene& world, std::uint64_t seed)
      : plant(config, world, seed), device(config.fotokite, plant) {}

  Plant plant;
  FotokiteEmulator device;
};

Simulator::Simulator(const SimConfig& config, const Scene& world, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(config, world, seed)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

void Simulator::advanceTo(Time t) noexcept {
  while (impl_->plant.now() + impl_->plant.stepDuration() <= t) {
    impl_->plant.step();
    impl_->device.advance();
  }
}

void Simulator::receive(std::span<const std::uint8_t> bytes) noexcept {
  impl_->device.receive(bytes);
}

std::size_t Simulator::transmit(std::span<std::uint8_t> out) noexcept {
  return impl_->device.transmit(out);
}

const Truth& Simulator::truth() const noexcept { return impl_->plant.truth(); }
Time Simulator::now() const noexcept { return impl_->plant.now(); }

}  // namespace tautline::sim
