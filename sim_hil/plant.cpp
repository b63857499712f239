#include "sim_hil/plant.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.h"

namespace tautline::sim {
namespace {

constexpr double kGravity = 9.81;
constexpr int kStepsPerAirUpdate = 10;
constexpr double kDefaultFoot = 0.1;   // [m]
constexpr double kSameContact = 0.05;  // contacts nearer than this on one obstacle are one [m]
constexpr double kReleased = 1.0;      // a tether that was held follows its reel again [m/s]
constexpr double kOnGround = 0.02;     // attachment this near its parking height stands [m]

/// Height of the attachment over the ground when parked, from the scene's start.
double footOf(const Obstacles& obstacles, const Eigen::Vector3d& start) {
  return std::clamp(start.y() - obstacles.groundBelow(start), 0.02, 0.3);
}

Eigen::Vector3d startOf(const Scene& world) {
  return world.start.value_or(Eigen::Vector3d(0.0, world.floor + kDefaultFoot, 1.0));
}

/// Stands on its feet, exactly.
Eigen::Vector3d standing(const Obstacles& obstacles, Eigen::Vector3d start) {
  start.y() = obstacles.groundBelow(start) + footOf(obstacles, start);
  return start;
}

}  // namespace

Plant::Plant(const SimConfig& config, const Scene& world, std::uint64_t seed)
    : Plant(config, Obstacles(world), startOf(world), seed) {
  if (const auto hit = firstHit(Eigen::Vector3d::Zero(), p_start_, world)) {
    throw InputError({.file = {},
                      .line = 0,
                      .key = "start_m",
                      .problem = "\"" + hit->obstacle + "\" stands between the reel and the start",
                      .allowed = "a start in straight sight of the reel",
                      .remedy = "move the start or the reel of scene \"" + world.name + "\""});
  }
}

Plant::Plant(const SimConfig& config, Obstacles obstacles, const Eigen::Vector3d& start,
             std::uint64_t seed)
    : config_(config),
      step_(fromSeconds(config.step)),
      h_(toSeconds(step_)),
      obstacles_(std::move(obstacles)),
      random_(seed),
      p_start_(standing(obstacles_, start)),
      foot_(footOf(obstacles_, start)),
      ground_(obstacles_.groundBelow(p_start_)),
      tether_(config.tether, p_start_, p_start_.norm() * (1.0 + config.start_slack)),
      reel_(config.reel, tether_.length()),
      vehicle_(config.vehicle),
      wind_(config.wind),
      sensors_(config.sensors,
               SensorInput{reel_.counts(), polarOf(p_start_), Eigen::Quaterniond::Identity(), 0.0}),
      faults_(seed) {
  updateTruth();
}

void Plant::step() noexcept {
  if (air_countdown_-- == 0) {
    stepAir();
    air_countdown_ = kStepsPerAirUpdate - 1;
  }
  const Eigen::Vector3d v_before = truth_.v_WD;
  faults_.update(truth_.time);
  stepFaults();
  stepReel();

  VehicleSense sense;
  sense.bias = {config_.sensors.elevation_bias, config_.sensors.azimuth_bias};
  sense.tangent = {truth_.tangent_elevation + sense.bias.elevation,
                   truth_.tangent_azimuth + sense.bias.azimuth};
  sense.tension = truth_.tension;
  sense.v_WD = truth_.v_WD;
  sense.length = truth_.length;
  sense.length_rate = reel_.rate();
  sense.on_ground = truth_.on_ground;
  vehicle_.step(h_, sense);

  EndLoad end;
  end.mass = config_.vehicle.mass;
  end.force = vehicle_.thrust() - Eigen::Vector3d(0.0, kGravity * end.mass, 0.0);
  end.drag = config_.vehicle.drag;
  end.ground = ground_ + foot_;
  tether_.step(h_, reel_.length() - behind_, end, air(), obstacles_);

  truth_.time += step_;
  stepClock();
  updateTruth();
  checkCrash(v_before);
  sensors_.step(truth_.time, sensorInput(), random_);
}

/// What faults make of reel, vehicle and tether in this step.
void Plant::stepFaults() noexcept {
  using M = FaultMode;
  using T = FaultTarget;
  const auto node = [this](const Fault& f) {
    return static_cast<int>(std::lround(f.value * tether_.linkCount()));
  };
  ReelDisturbance reel = reel_faults_.step(reel_.wanted(), faults_);
  TetherDisturbance tether;
  VehicleDisturbance vehicle;
  const Fault* snag = faults_.active(T::kTether, M::kSnag);
  if (snag != nullptr) {
    tether.held_node = node(*snag);
    reel.min_length = tether_.length();
  }
  tether.cut_link = tether_.cutLink();
  if (const Fault* cut = faults_.active(T::kTether, M::kBreak); cut != nullptr && !cut_) {
    cut_ = true;
    tether.cut_link = std::clamp(node(*cut), 1, tether_.linkCount()) - 1;
  }
  if (const Fault* f = faults_.active(T::kTether, M::kContactSlip)) tether.friction = f->value;
  tether.no_contacts = faults_.active(T::kTether, M::kContactOff) != nullptr;
  if (const Fault* f = faults_.active(T::kTether, M::kOverTension)) vehicle.tension = f->value;
  if (const Fault* f = faults_.active(T::kMotors, M::kMotorWeak)) vehicle.thrust_limit = f->value;
  if (faults_.active(T::kMotors, M::kOff) != nullptr) vehicle_.stopMotors();
  held_ = snag != nullptr || cut_;
  reel_.disturb(reel);
  tether_.disturb(tether);
  vehicle_.disturb(vehicle);
}

/// The drum turns; a tether that is held or cut stays as long as it is.
void Plant::stepReel() noexcept {
  const double before = reel_.length();
  reel_.step(h_, truth_.reel_tension);
  behind_ = held_ ? behind_ + reel_.length() - before
                  : behind_ - std::clamp(behind_, -kReleased * h_, kReleased * h_);
}

void Plant::stepClock() noexcept {
  using M = FaultMode;
  const auto active = [this](M mode) { return faults_.active(FaultTarget::kClock, mode); };
  const Fault* slow = active(M::kSlow);
  const bool open = clock_contact_.open(active(M::kIntermittent), faults_);
  const bool stands = open || active(M::kStuck) != nullptr;
  if (!stands) clock_ += slow != nullptr ? fromSeconds(slow->value * h_) : step_;
  const Fault* jump = active(M::kWrong);
  if (jump != nullptr && !clock_jumped_) clock_ += fromSeconds(jump->value);
  clock_jumped_ = jump != nullptr;
}

void Plant::stepAir() noexcept {
  ground_ = obstacles_.groundBelow(truth_.p_WD);
  wind_.step(kStepsPerAirUpdate * h_,
             obstacles_.confinement(truth_.p_WD, config_.wind.wall_distance), random_);
}

void Plant::checkCrash(const Eigen::Vector3d& v_before) noexcept {
  if (truth_.crashed) return;
  const bool was_on_ground = truth_.on_ground;
  const bool fell = truth_.time > Time{} + step_ && tether_.groundForce() > 0.0 &&
                    -v_before.y() > config_.vehicle.survivable_impact;
  if (fell) crash(CrashReason::kHardLanding);
  if (was_on_ground) return;
  const double radius = config_.vehicle.radius;
  if (obstacles_.touches(truth_.p_WD, radius, foot_)) {
    crash(CrashReason::kObstacle);
  } else if (obstacles_.hasRoom()) {
    const Aabb& room = obstacles_.room();
    const Eigen::Vector3d& p = truth_.p_WD;
    const bool inside = p.x() - radius >= room.min.x() && p.x() + radius <= room.max.x() &&
                        p.z() - radius >= room.min.z() && p.z() + radius <= room.max.z() &&
                        p.y() + radius <= room.max.y();
    if (!inside) crash(CrashReason::kRoom);
  }
}

void Plant::crash(CrashReason reason) noexcept {
  truth_.crashed = true;
  truth_.crash_reason = reason;
  vehicle_.stopMotors();
  truth_.motors_on = false;
}

void Plant::updateTruth() noexcept {
  const int last = tether_.linkCount();
  truth_.p_WD = tether_.position(last);
  truth_.v_WD = tether_.velocity(last);
  const Eigen::Vector3d pull = tether_.endTension();
  const Polar tangent = polarOf(pull);
  truth_.tension = pull.norm();
  truth_.reel_tension = reel_.stalled() ? config_.reel.slip_tension : tether_.reelTension();
  truth_.length = tether_.length();
  truth_.reel_scale = reel_.scale();
  truth_.tangent_elevation = tangent.elevation;
  truth_.tangent_azimuth = tangent.azimuth;
  truth_.setpoint_elevation = vehicle_.setpoint().elevation;
  truth_.setpoint_azimuth = vehicle_.setpoint().azimuth;
  truth_.yaw = vehicle_.yaw();
  truth_.gimbal_pitch = vehicle_.gimbalPitch();
  truth_.on_ground = truth_.p_WD.y() < ground_ + foot_ + kOnGround;
  truth_.motors_on = vehicle_.motorsOn();
  truth_.gust = air();
  updateContacts();
}

/// Bends and faces in the order of the tether; what is near on the same obstacle is one contact.
void Plant::updateContacts() noexcept {
  truth_.contact_count = 0;
  truth_.p_WA.setZero();
  int last_obstacle = -1;
  const auto count = [&](int solid, const Eigen::Vector3d& p) {
    const int obstacle = obstacles_.solids()[static_cast<std::size_t>(solid)].obstacle;
    const bool same = obstacle == last_obstacle && (p - truth_.p_WA).norm() < kSameContact;
    if (!same) ++truth_.contact_count;
    truth_.p_WA = p;
    last_obstacle = obstacle;
  };
  auto faces = tether_.faceContacts();
  for (const EdgeContact& bend : tether_.bends()) {
    for (; !faces.empty() && faces[0].link < bend.link; faces = faces.subspan(1)) {
      count(faces[0].solid, tether_.contactPoint(faces[0]));
    }
    count(bend.solid, bend.point());
  }
  for (const FaceContact& c : faces) count(c.solid, tether_.contactPoint(c));
}

Eigen::Vector3d Plant::air() const noexcept {
  Eigen::Vector3d velocity = wind_.velocity();
  faults_.forEachActive(FaultTarget::kAir, FaultMode::kGust,
                        [&](const Fault& f) { velocity += f.velocity; });
  return velocity;
}

SensorInput Plant::sensorInput() const noexcept {
  return {reel_.counts(),
          {truth_.tangent_elevation, truth_.tangent_azimuth},
          vehicle_.attitude(),
          truth_.p_WD.y() - p_start_.y()};
}

}  // namespace tautline::sim
