#include "sim_hil/sensor_faults.h"

#include <cmath>
#include <numbers>

namespace tautline::sim {
namespace {

constexpr double kGarbageLength = 50.0;  // [m]

}  // namespace

template <class T>
bool SensorFaults::Channel<T>::pass(FaultTarget target, T& value, FaultSchedule& faults) noexcept {
  const Time now = faults.now();
  history_.put(now, value);
  if (const Fault* late = faults.active(target, FaultMode::kDelayed))
    value = history_.at(now - fromSeconds(late->value));
  if (faults.active(target, FaultMode::kStuck) != nullptr && had_last_) value = last_;
  last_ = value;
  had_last_ = true;

  if (faults.active(target, FaultMode::kOff) != nullptr) return true;
  if (contact_.open(faults.active(target, FaultMode::kIntermittent), faults)) return true;
  const Fault* slow = faults.active(target, FaultMode::kSlow);
  if (slow == nullptr) return false;
  if (now < next_slow_) return true;
  next_slow_ = now + fromSeconds(1.0 / slow->value);
  return false;
}

SensorReadings SensorFaults::apply(const SensorReadings& good, double metres_per_count,
                                   FaultSchedule& faults) noexcept {
  SensorReadings r = good;
  Random& random = faults.random();

  r.encoder_silent = encoder_.pass(FaultTarget::kEncoder, r.counts, faults);
  if (const Fault* f = faults.active(FaultTarget::kEncoder, FaultMode::kWrong))
    r.counts += std::llround(f->value / metres_per_count);
  if (faults.active(FaultTarget::kEncoder, FaultMode::kGarbage) != nullptr)
    r.counts = std::llround(kGarbageLength * random.signedUniform() / metres_per_count);

  r.angles_silent = angles_.pass(FaultTarget::kAngles, r.tangent, faults);
  if (const Fault* f = faults.active(FaultTarget::kAngles, FaultMode::kWrong))
    r.tangent = {r.tangent.elevation + f->value, wrapped(r.tangent.azimuth + f->value)};
  if (faults.active(FaultTarget::kAngles, FaultMode::kGarbage) != nullptr)
    r.tangent = polarOf(random.normal3());

  r.attitude_silent = attitude_.pass(FaultTarget::kAttitude, r.attitude, faults);
  if (const Fault* f = faults.active(FaultTarget::kAttitude, FaultMode::kWrong))
    r.attitude =
        Eigen::Quaterniond(Eigen::AngleAxisd(f->value, Eigen::Vector3d::UnitX())) * r.attitude;
  if (faults.active(FaultTarget::kAttitude, FaultMode::kGarbage) != nullptr) {
    const Eigen::Vector3d v = random.normal3();
    r.attitude = Eigen::Quaterniond(random.normal(), v.x(), v.y(), v.z()).normalized();
  }
  return r;
}

double SensorFaults::voltage(double good, FaultSchedule& faults) noexcept {
  if (faults.now() == voltage_time_) return voltage_;
  using M = FaultMode;
  constexpr auto kTarget = FaultTarget::kBattery;
  const bool known = voltage_time_ != Time::min();
  voltage_time_ = faults.now();
  if (faults.active(kTarget, M::kStuck) == nullptr || !known) voltage_ = good;
  if (const Fault* f = faults.active(kTarget, M::kWrong)) voltage_ = good + f->value;
  if (faults.active(kTarget, M::kGarbage) != nullptr)
    voltage_ = good * (1.0 + faults.random().signedUniform());
  const bool open = voltage_contact_.open(faults.active(kTarget, M::kIntermittent), faults);
  if (open || faults.active(kTarget, M::kOff) != nullptr) voltage_ = 0.0;
  voltage_ = std::fmax(0.0, voltage_);
  return voltage_;
}

}  // namespace tautline::sim
