#include "app/report/test/synthetic_flight.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <lcm/lcm-cpp.hpp>
#include <tautline/command_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/loop_stats_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/params_t.hpp>
#include <tautline/sim_truth_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>
#include <tautline/vehicle_state_t.hpp>

#include "common/tether_geometry.h"
#include "supervision/supervisor.h"

namespace tautline::report {
namespace {

constexpr double kTakeoffAt = 3.0;
constexpr double kLandingTime = 5.0;
constexpr double kFloor = -0.6;

void copy(const Eigen::Vector3d& v, double (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

class Writer {
 public:
  Writer(const SyntheticFlight& flight, const std::filesystem::path& file)
      : flight_(flight), log_(file.string(), "w") {
    double t = kSyntheticMissionStart;
    for (std::size_t i = 1; i < syntheticCorners().size(); ++i) {
      begin_.push_back(t);
      t += (syntheticCorners()[i] - syntheticCorners()[i - 1]).norm() / kSyntheticSpeed;
    }
    mission_end_ = flight.completes ? t : t - 2.0;
    end_ = mission_end_ + 2.0 + kLandingTime + 2.0;
  }

  void write() {
    publishPlan();
    publishParams();
    const int ticks =
        static_cast<int>(std::floor((flight_.lands ? end_ : mission_end_ + 1.0) * 50.0));
    for (int i = 0; i <= ticks; ++i) tick(i * 0.02, i);
  }

 private:
  template <class Message>
  void publish(const char* channel, Message& message, double t) {
    message.utime = flight_.start_utime + std::llround(t * 1e6);
    std::vector<unsigned char> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm::LogEvent event{};
    event.timestamp = message.utime;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(bytes.size());
    event.data = bytes.data();
    log_.writeEvent(&event);
  }

  [[nodiscard]] std::size_t legAt(double t) const {
    const auto next = std::upper_bound(begin_.begin(), begin_.end(), t);
    return next == begin_.begin() ? 0 : static_cast<std::size_t>(next - begin_.begin()) - 1;
  }

  [[nodiscard]] Eigen::Vector3d home() const {
    return {syntheticCorners()[0].x(), kFloor, syntheticCorners()[0].z()};
  }

  [[nodiscard]] Eigen::Vector3d inMission(double t) const {
    const std::size_t leg = legAt(t);
    const Eigen::Vector3d& a = syntheticCorners()[leg];
    const Eigen::Vector3d& b = syntheticCorners()[leg + 1];
    const double s = std::clamp((t - begin_[leg]) * kSyntheticSpeed / (b - a).norm(), 0.0, 1.0);
    const Eigen::Vector3d sideways = Eigen::Vector3d::UnitY().cross(b - a).normalized();
    const double fade = std::sin(3.14159 * s);
    return a + s * (b - a) + Eigen::Vector3d(0, flight_.offset_y, 0) +
           flight_.wobble * fade * std::sin(1.3 * t) * sideways;
  }

  [[nodiscard]] Eigen::Vector3d position(double t) const {
    if (t < kTakeoffAt) return home();
    const Eigen::Vector3d first = syntheticCorners()[0];
    if (t < kSyntheticMissionStart) {
      const double s = std::min(1.0, (t - kTakeoffAt) / 4.0);
      return home() + s * s * (3 - 2 * s) * (first - home());
    }
    if (t <= mission_end_) return inMission(t);
    const Eigen::Vector3d last = inMission(mission_end_);
    const double s = std::clamp((t - mission_end_ - 2.0) / kLandingTime, 0.0, 1.0);
    return last + s * (Eigen::Vector3d(last.x(), kFloor, last.z()) - last);
  }

  [[nodiscard]] bool onGround(double t) const {
    return t < kTakeoffAt || t > mission_end_ + 2.0 + kLandingTime;
  }

  void publishPlan() {
    if (!flight_.with_plan) return;
    const auto& corners = syntheticCorners();
    mission_chunk_t chunk{};
    chunk.mission_hash = kSyntheticHash;
    chunk.waypoint_total = static_cast<int>(corners.size()) - 1;
    chunk.contact_total = 1;
    chunk.kind = 1;
    chunk.count = 1;
    copy(syntheticContact(), chunk.position_m[0]);
    chunk.contact_id[0] = 1;
    publish("MISSION_CHUNK", chunk, 0.5);
    chunk.kind = 0;
    for (int i = 0; i < chunk.waypoint_total; ++i) {  // one chunk a waypoint, the last one first
      chunk.first = chunk.waypoint_total - 1 - i;
      copy(corners[static_cast<std::size_t>(chunk.first) + 1], chunk.position_m[0]);
      chunk.contact_id[0] = chunk.first >= 2 ? 1 : 0;
      publish("MISSION_CHUNK", chunk, 0.5);
    }
  }

  void publishParams() {
    params_t params{};
    params.program = "tautline-station";
    params.version = "1.2.3";
    params.toml = "[loop]\nrate_hz = 100\n";
    publish("PARAMS", params, 0.0);
  }

  void publishEvent(double t, int severity, const std::string& text, const std::string& reaction) {
    event_t event{};
    event.severity = static_cast<std::int8_t>(severity);
    event.code = 7;
    event.text = text;
    event.reaction = reaction;
    event.remedy = severity > 0 ? "look at the <b>tether</b> & wait" : "";
    publish("EVENT", event, t);
  }

  void tick(double t, int i) {
    if (flight_.with_truth) publishTruth(t);
    if (i % 5 != 0) return;
    publishState(t);
    publishEstimate(t);
    publishTether(t);
    publishVehicle(t);
    publishMission(t);
    publishCommand(t, i / 5);
    if (i % 50 == 0) publishLoop(t, i / 50);
    if (i == 150) publishEvent(t, 0, "Take-off", "climbing to the hover point");
    if (i == 700) publishEvent(t, 1, "Reel sample 320 ms old", "holding until the next one");
  }

  void publishTruth(double t) {
    sim_truth_t m{};
    const Eigen::Vector3d p = position(t);
    copy(p, m.position_m);
    copy((position(t + 1e-3) - position(t - 1e-3)) / 2e-3, m.velocity_mps);
    if (t > mission_end_ + 3.0)
      copy(Eigen::Vector3d(0, -flight_.touchdown_speed, 0), m.velocity_mps);
    const bool contact = legAt(t) >= 2;
    const Eigen::Vector3d anchor = contact ? syntheticContact() : Eigen::Vector3d::Zero();
    const TetherCoordinates q = toTether(p - anchor);
    m.length_m = q.L + anchor.norm();
    m.tangent_elevation_rad = q.theta + 0.05;
    m.tangent_azimuth_rad = q.phi;
    m.tension_n = 0.8 + 0.2 * std::sin(2.0 * t);
    m.reel_tension_n = m.tension_n;
    m.reel_scale = 1.02;
    m.on_ground = onGround(t) ? 1 : 0;
    m.crashed = 0;
    m.crash_reason = 0;
    m.motors_on = t >= 2.5 && t <= mission_end_ + 3.0 + kLandingTime ? 1 : 0;
    m.contact_count = contact ? 1 : 0;
    copy(anchor, m.anchor_m);
    publish("SIM_TRUTH", m, t);
  }

  void publishState(double t) {
    station_state_t m{};
    m.run_mode = 0;
    const Mode mode = t < 2.0                      ? Mode::kStandby
                      : t < kTakeoffAt             ? Mode::kArmed
                      : t < 7.0                    ? Mode::kTakeoff
                      : t < kSyntheticMissionStart ? Mode::kHold
                      : t <= mission_end_          ? Mode::kAuto
                      : t <= mission_end_ + 2.0    ? Mode::kHold
                      : onGround(t)                ? Mode::kStandby
                                                   : Mode::kLand;
    m.mode = static_cast<std::int8_t>(mode);
    m.mission_hash = kSyntheticHash;
    m.mission_items = 4;
    publish("STATION_STATE", m, t);
  }

  void publishEstimate(double t) {
    estimate_t m{};
    m.valid = 1;
    copy(position(t) + Eigen::Vector3d(0, 0, flight_.estimate_offset_z), m.position_m);
    m.tension_n = 0.8;
    m.reel_scale = 1.0 + 0.02 * (1.0 - std::exp(-t / 10.0));
    publish("ESTIMATE", m, t);
  }

  void publishTether(double t) {
    tether_state_t m{};
    const bool contact = legAt(t) >= 2;
    const Eigen::Vector3d anchor = contact ? syntheticContact() : Eigen::Vector3d::Zero();
    const TetherCoordinates q = toTether(position(t) - anchor);
    m.length_free_m = q.L;
    m.length_static_m = anchor.norm();
    m.length_meas_m = (q.L + anchor.norm()) / 1.02;
    m.elevation_rad = q.theta + 0.05;
    m.azimuth_rad = q.phi;
    m.tension_n = 0.8;
    m.contact_count = contact ? 1 : 0;
    m.contact_id = contact ? 1 : 0;
    copy(anchor, m.anchor_m);
    publish("TETHER_STATE", m, t);
  }

  void publishVehicle(double t) {
    vehicle_state_t m{};
    m.phase = static_cast<std::int8_t>(t < kTakeoffAt ? 1 : !onGround(t) ? 2 : 4);
    m.attitude_wxyz[0] = 1.0;
    publish("VEHICLE_STATE", m, t);
  }

  void publishMission(double t) {
    mission_status_t m{};
    m.mission_hash = kSyntheticHash;
    m.waypoint_count = static_cast<int>(syntheticCorners().size()) - 1;
    if (t >= kSyntheticMissionStart) {
      const std::size_t leg = legAt(std::min(t, mission_end_));
      const bool running = t <= mission_end_;
      m.state = static_cast<std::int8_t>(running ? 1 : flight_.completes ? 4 : 5);
      m.failure = static_cast<std::int8_t>(!running && !flight_.completes ? 2 : 0);
      m.waypoint = static_cast<int>(leg);
      copy(syntheticCorners()[leg], m.segment_start_m);
      copy(syntheticCorners()[leg + 1], m.target_m);
    }
    publish("MISSION_STATUS", m, t);
  }

  void publishCommand(double t, int index) {
    command_t m{};
    m.engaged = t >= kTakeoffAt ? 1 : 0;
    m.length_rate_mps = 0.1;
    m.elevation_rate_radps =
        index % 2 == 0 ? 0.05 : -0.05;  // changes its sign with every message: 10 a second
    publish("COMMAND", m, t);
  }

  void publishLoop(double t, int second) {
    loop_stats_t m{};
    m.period_s = 0.01;
    m.cycles = 100 * second;
    m.overruns = second / 20;
    m.lateness_mean_s = 12e-6;
    m.lateness_max_s = (60 + 40 * (second % 7)) * 1e-6;
    m.work_mean_s = 85e-6;
    m.work_max_s = (150 + 30 * (second % 5)) * 1e-6;
    m.work_max_ever_s = 270e-6;
    publish("LOOP_STATS", m, t);
  }

  SyntheticFlight flight_;
  lcm::LogFile log_;
  std::vector<double> begin_;  // Of the legs [s].
  double mission_end_{};
  double end_{};
};

}  // namespace

const std::vector<Eigen::Vector3d>& syntheticCorners() {
  static const std::vector<Eigen::Vector3d> corners{
      {0.6, 1.0, 0.8}, {2.4, 1.0, 0.8}, {2.6, 1.0, -0.6}, {1.2, 1.0, -2.2}, {-0.8, 1.0, -1.8}};
  return corners;
}

Eigen::Vector3d syntheticContact() { return {1.4, 0.4, -0.2}; }

void writeSyntheticLog(const SyntheticFlight& flight, const std::filesystem::path& file) {
  Writer(flight, file).write();
}

}  // namespace tautline::report
