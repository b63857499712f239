#include "app/experiments/replayed_flight.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>

#include "app/experiments/published_flights.h"
#include "app/station/condition_monitor.h"
#include "common/tether_geometry.h"
#include "control/contact_stack.h"
#include "control/motion_executor.h"
#include "drivers/fotokite_device.h"
#include "estimation/localizer.h"
#include "supervision/supervisor.h"

namespace tautline::experiments {
namespace {

InputError tooLong(const char* what) {
  return InputError({.problem = std::string("has more ") + what + " than a mission can hold"},
                    ExitCode::kFailed);
}

constexpr double kSamePoint = 1e-5;    // the log's digits [m]
constexpr double kAtReel = 0.02;       // a contact this near the origin is the reel [m]
constexpr double kPositionOff = 2e-3;  // [m]

/// The reel outlet in the log's frame.
Eigen::Vector3d reelOf(const Recording& recording) {
  for (const RecordedPose& pose : recording.poses)
    if (pose.row.p_WA.norm() < kAtReel && !pose.row.p_WA.isZero()) return pose.row.p_WA;
  // Without contact columns it is what positions begin from.
  const FlightLogRow& row = recording.poses.front().row;
  const Eigen::Vector3d from_reel =
      toCartesian({row.length, row.elevation, row.azimuth + std::numbers::pi / 2.0});
  return row.p_WD - from_reel;
}

/// The log's way as a mission: a waypoint whenever the target changes, with the contact that it
/// names.
std::unique_ptr<MissionPlan> missionOf(const Recording& recording) {
  const Eigen::Vector3d reel = reelOf(recording);
  const std::vector<Eigen::Vector3d> contacts = contactsOf(recording);
  auto plan = std::make_unique<MissionPlan>();
  plan->hash = 1;
  if (contacts.size() > static_cast<std::size_t>(kMaxContacts)) throw tooLong("contacts");
  for (const Eigen::Vector3d& contact : contacts) {
    const int i = plan->contact_count++;
    plan->contacts[static_cast<std::size_t>(i)] = {.id = i + 1, .p_WC = contact - reel};
  }
  const FlightLogRow* last = nullptr;
  for (const RecordedPose& pose : recording.poses) {
    const FlightLogRow& row = pose.row;
    if (last != nullptr && last->p_WTarget == row.p_WTarget) continue;
    last = &row;
    Waypoint waypoint;
    waypoint.p_WD = row.p_WTarget - reel;
    for (std::size_t c = 0; c < contacts.size(); ++c)
      if ((contacts[c] - row.p_WA).norm() < kSamePoint) waypoint.contact = static_cast<int>(c) + 1;
    if (plan->waypoint_count == kMaxWaypoints) throw tooLong("waypoints");
    plan->waypoints[static_cast<std::size_t>(plan->waypoint_count++)] = waypoint;
  }
  return plan;
}

FotokiteConfig deviceOf(const StationConfig& station) {
  FotokiteConfig device = station.fotokite;
  device.length_scale_m_per_count = kLoggedMetresPerCount;
  device.elevation_offset_rad = kLoggedQuarterTurn - std::numbers::pi / 2.0;
  return device;
}

/// Its acceptance radius is the log's, nothing else ends a leg, and no leg is given up.
ExecutorConfig publishedExecutor(double acceptance_radius) {
  ExecutorConfig config;
  config.acceptance_floor_m = acceptance_radius;
  config.acceptance_ceiling_m = acceptance_radius;
  config.pass_by_progress = false;
  config.timeout_constant_s = 3600.0;
  config.progress_time_s = 3600.0;
  config.unreachable_time_s = 60.0;
  config.target.model = TetherModel::kStraight;
  return config;
}

/// It had no way round the pole: waypoints there were as any others.
PoleConfig noPole() {
  PoleConfig pole;
  pole.detour_speed_mps = 0.01;
  pole.radius_max_m = 0.05;
  pole.margin_m = 0.0;
  return pole;
}

bool isWrong(Condition condition) {
  constexpr ConditionSet kNotWrong =
      conditionsOf(ConditionKind::kFact) | ConditionSet{Condition::kVehicleFlying};
  return !kNotWrong.has(condition);
}

}  // namespace

std::vector<Eigen::Vector3d> contactsOf(const Recording& recording) {
  std::vector<Eigen::Vector3d> contacts;
  for (const RecordedPose& pose : recording.poses) {
    const Eigen::Vector3d& contact = pose.row.p_WA;
    const auto same = [&](const Eigen::Vector3d& c) { return (c - contact).norm() < kSamePoint; };
    if (contact.norm() > kAtReel && std::none_of(contacts.begin(), contacts.end(), same))
      contacts.push_back(contact);
  }
  return contacts;
}

/// A row is a cycle of its program: sensors, position, target, and on to the next target if it is
/// near enough.
LogAgreement agreement(const Recording& recording, const StationConfig& station,
                       bool with_targets) {
  LogAgreement result;
  const Eigen::Vector3d reel = reelOf(recording);
  const std::unique_ptr<MissionPlan> mission = missionOf(recording);
  TelegramPort port(telegramsOf(recording, Duration::zero(), Eigen::Vector3d::UnitX()));
  FotokiteDevice device(port, deviceOf(station));
  LocalizerConfig localizer_config = station.core.localizer;
  localizer_config.variant = LocalizerVariant::kStraight;
  const auto localizer = std::make_unique<Localizer>(localizer_config);
  localizer->reset(Eigen::Vector3d::Zero(), recording.cycles.front().now);
  ContactStack contacts;
  MotionExecutor executor(publishedExecutor(recording.poses.front().row.acceptance_radius),
                          noPole(), station.core.limits, contacts);
  SensorFrame frame;
  bool started = false;
  int waypoint = -1;
  const FlightLogRow* last = nullptr;
  for (std::size_t i = 0; i < recording.cycles.size(); ++i) {
    const Time now = recording.cycles[i].now;
    const FlightLogRow& row = recording.poses[i].row;
    if (last == nullptr || last->p_WTarget != row.p_WTarget) ++waypoint;
    last = &row;
    device.read(now, frame);
    const Estimate estimate = localizer->update(now, frame, VehicleCommand{}, contacts.anchor());
    const double off = (estimate.p_WD + reel - row.p_WD).norm();
    ++result.rows;
    result.position = std::max(result.position, off);
    result.position_off += off <= kPositionOff ? 0 : 1;  // NaN is off
    if (!with_targets) continue;
    if (!started) started = executor.start(*mission, estimate);
    const ExecutorStatus& status = executor.status();
    ++result.targets;
    const bool finite = std::isfinite(row.target_length) && std::isfinite(row.target_elevation) &&
                        std::isfinite(row.target_azimuth) && std::isfinite(status.target_length);
    result.other_target += status.waypoint == waypoint && finite ? 0 : 1;
    result.target_length =
        std::max(result.target_length, std::abs(status.target_length - row.target_length));
    result.target_elevation =
        std::max(result.target_elevation, std::abs(status.target_elevation - row.target_elevation));
    result.target_azimuth = std::max(
        result.target_azimuth,
        std::abs(wrapAngle(status.target_azimuth - std::numbers::pi / 2.0 - row.target_azimuth)));
    const Duration dt = i > 0 ? now - recording.cycles[i - 1].now : Duration::zero();
    static_cast<void>(executor.update(dt, {.estimate = estimate}));
  }
  return result;
}

namespace {

/// The largest of which all lengths are multiples, to the digits of the log, refined by least
/// squares.
std::optional<double> quantumOf(const std::set<double>& lengths) {
  constexpr std::size_t kEnough = 8;
  constexpr double kLargest = 0.02;   // [m]
  constexpr double kSmallest = 1e-3;  // [m]
  constexpr double kDigits = 2e-5;    // [m]
  if (lengths.size() < kEnough) return std::nullopt;
  const double step = 0.5 * kDigits * kSmallest / *lengths.rbegin();
  for (double q = kLargest; q > kSmallest; q -= step) {
    const auto is_multiple = [q](double length) {
      return std::abs(length - q * std::round(length / q)) < kDigits;
    };
    if (!std::all_of(lengths.rbegin(), lengths.rend(), is_multiple)) continue;
    double above = 0.0;
    double below = 0.0;
    for (const double length : lengths) {
      const double n = std::round(length / q);
      above += n * length;
      below += n * n;
    }
    return above / below;
  }
  return std::nullopt;
}

}  // namespace

LogFigures figuresOf(const Recording& recording) {
  LogFigures figures;
  std::set<double> lengths;
  int changes = 0;
  int in_second = 0;
  std::set<std::int64_t> seconds;
  const FlightLogRow* last = nullptr;
  for (const RecordedPose& pose : recording.poses) {
    const FlightLogRow& row = pose.row;
    lengths.insert(row.length);
    if (last != nullptr && (last->length != row.length || last->elevation != row.elevation ||
                            last->azimuth != row.azimuth))
      ++changes;
    in_second = last != nullptr && last->second == row.second ? in_second + 1 : 1;
    figures.fullest_second = std::max(figures.fullest_second, in_second);
    last = &row;
  }
  figures.duration = toSeconds(recording.length());
  figures.lengths = static_cast<int>(lengths.size());
  figures.quantum = quantumOf(lengths);
  figures.new_samples = figures.duration > 0.0 ? changes / figures.duration : 0.0;
  return figures;
}

namespace {

constexpr Duration kReplayPeriod = std::chrono::milliseconds(10);
constexpr Duration kParked = std::chrono::seconds(6);  // before the first pose

/// The station's configuration for a flight whose commands are not in the log.
CoreConfig coreFor(const StationConfig& station, const Eigen::Vector3d& home) {
  constexpr double kUnknownVelocity = 0.5;  // any velocity that the vehicle can have [m/s]
  CoreConfig core = station.core;
  core.guidance.home_position_m = home;
  core.localizer.process.velocity_sigma_mps = kUnknownVelocity;
  core.localizer.noise.use_altitude = false;
  core.detect.contact.height_residual_m = 100.0;
  return core;
}

/// An operator who arms, takes off at `first` and navigates.
Request requestIn(Mode mode, Time now, Time first) {
  if (mode == Mode::kStandby && now < first) return Request::kArm;
  if (mode == Mode::kArmed) return Request::kTakeoff;
  if (mode == Mode::kHold) return Request::kNavigate;
  return Request::kNone;
}

/// What the supervisor did `t` seconds after the first pose, in one cycle.
void note(double t, const SupervisorOutput& out, ConditionSet conditions,
          SupervisorVerdict& verdict) {
  verdict.last_mode = out.mode;
  if (out.changed && !out.reasons.empty() && !verdict.intervened && out.mode > Mode::kAuto) {
    verdict.intervened = t;
    verdict.mode = out.mode;
    verdict.reasons = out.reasons;
  }
  for (const ConditionInfo& info : kConditionInfos) {
    if (!conditions.has(info.condition) || !isWrong(info.condition)) continue;
    auto at = std::find_if(verdict.raised.begin(), verdict.raised.end(),
                           [&](const auto& r) { return r.condition == info.condition; });
    if (at == verdict.raised.end()) {
      verdict.raised.push_back({info.condition, t, 0.0});
      at = verdict.raised.end() - 1;
    }
    at->lasted += toSeconds(kReplayPeriod);
  }
}

}  // namespace

SupervisorVerdict verdictOn(const Recording& recording, const StationConfig& station) {
  constexpr Duration kClimb = std::chrono::seconds(1);
  // What the logs do not have is not judged: attitude, and commands.
  constexpr ConditionSet kNotLogged{Condition::kAttitudeStale};
  Eigen::Vector3d home = recording.poses.front().p_WD - reelOf(recording);
  home.y() = 0.0;
  const CoreConfig core = coreFor(station, home);
  TelegramPort port(telegramsOf(recording, kParked, home));
  FotokiteDevice device(port, deviceOf(station));
  const auto localizer = std::make_unique<Localizer>(core.localizer);
  const auto monitor = std::make_unique<ConditionMonitor>(core);
  Supervisor supervisor(core.supervisor);
  const std::unique_ptr<MissionPlan> mission = missionOf(recording);
  ContactStack contacts;
  SensorFrame frame;
  HostFacts host;
  host.run_mode = RunMode::kSim;
  host.device = DeviceReality::kEmulated;

  SupervisorVerdict verdict;
  const Time parked = recording.cycles.front().now;
  const Time first = parked + kParked;
  localizer->reset(home, parked);
  std::size_t next = 0;
  int waypoint = -1;
  std::int64_t cycles = 0;
  std::int64_t usable = 0;
  for (Time now = parked; now - kParked <= recording.cycles.back().now; now += kReplayPeriod) {
    for (; next < recording.cycles.size() && recording.cycles[next].now + kParked <= now; ++next) {
      const std::vector<RecordedPose>& poses = recording.poses;
      if (next == 0 || poses[next].row.p_WTarget != poses[next - 1].row.p_WTarget) ++waypoint;
    }
    if (waypoint >= 0) {
      const Waypoint& target = mission->waypoints[static_cast<std::size_t>(waypoint)];
      static_cast<void>(contacts.select(target.contact, *mission));
    }
    device.read(now, frame);
    const Anchor anchor = contacts.anchor();
    const VehicleCommand command;
    const Estimate estimate = localizer->update(now, frame, command, anchor);
    ConditionSet facts{Condition::kMissionLoaded};
    facts.set(Condition::kAtTarget, supervisor.mode() == Mode::kTakeoff && now >= first + kClimb);
    const ConditionSet conditions = monitor
                                        ->update({.now = now,
                                                  .sensors = &frame,
                                                  .health = &localizer->sensorHealth(),
                                                  .estimate = &estimate,
                                                  .anchor = &anchor,
                                                  .last_command = &command,
                                                  .host = &host,
                                                  .mode = supervisor.mode(),
                                                  .facts = facts})
                                        .without(kNotLogged);
    const SupervisorOutput out =
        supervisor.step(now, conditions, requestIn(supervisor.mode(), now, first));
    if (now < first) continue;
    ++cycles;
    usable += estimate.usable() ? 1 : 0;
    verdict.reel_scale = estimate.reel_scale;
    verdict.sigma_reel_scale = estimate.sigma_reel_scale;
    note(toSeconds(now - first), out, conditions, verdict);
  }
  verdict.usable = cycles > 0 ? static_cast<double>(usable) / static_cast<double>(cycles) : 0.0;
  return verdict;
}

}  // namespace tautline::experiments
