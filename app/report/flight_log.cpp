#include "app/report/flight_log.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <tautline/command_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/loop_stats_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/params_t.hpp>
#include <tautline/sim_truth_t.hpp>
#include <tautline/station_input_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>
#include <tautline/vehicle_state_t.hpp>

#include "app/log/event_log_reader.h"
#include "app/log/log_version.h"
#include "common/error.h"
#include "common/mission_plan.h"
#include "lcmtypes/channels.h"

namespace tautline::report {
namespace {

Eigen::Vector3d vector3(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

bool isFinite(const double (&v)[3]) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

// The value as an enumerator when the table knows it, else `otherwise`.
template <class Enum, std::size_t N>
Enum enumOr(int value, const std::array<EnumName<Enum>, N>& names, Enum otherwise) {
  for (const auto& entry : names) {
    if (static_cast<int>(entry.value) == value) return entry.value;
  }
  return otherwise;
}

// The generated decode() trusts the lengths of strings. Checks that `count` of them, and nothing
// else, follow at `offset`.
bool stringsFit(const LogEvent& event, std::size_t offset, int count) {
  const auto bytes = event.data;
  const std::size_t size = bytes.size();
  for (int i = 0; i < count; ++i) {
    if (offset + 4 > size) return false;
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = length << 8 | bytes[offset + k];
    offset += 4;
    if (length < 1 || length > size - offset || bytes[offset + length - 1] != 0) return false;
    offset += length;
  }
  return offset == size;
}

// Strings of these types start after the fingerprint and the fields before them.
bool stringsAreSound(const LogEvent& event, const event_t*) {
  return stringsFit(event, 8 + 8 + 1 + 4, 3);
}
bool stringsAreSound(const LogEvent& event, const params_t*) { return stringsFit(event, 8 + 8, 3); }
bool stringsAreSound(const LogEvent& event, const vehicle_state_t*) {
  constexpr int kEmptyString = 4 + 1;  // length and terminating zero
  static const int strings_at = 8 + vehicle_state_t{}._getEncodedSizeNoHash() - kEmptyString;
  return stringsFit(event, static_cast<std::size_t>(strings_at), 1);
}
bool stringsAreSound(const LogEvent&, const void*) { return true; }

struct UtimeSpan {
  std::int64_t first{std::numeric_limits<std::int64_t>::max()};
  std::int64_t last{std::numeric_limits<std::int64_t>::min()};

  void include(std::int64_t utime) {
    first = std::min(first, utime);
    last = std::max(last, utime);
  }
  [[nodiscard]] bool empty() const { return first > last; }
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    on<station_state_t>(channel::kStationState, &Reader::addState);
    on<estimate_t>(channel::kEstimate, &Reader::addEstimate);
    on<sim_truth_t>(channel::kSimTruth, &Reader::addTruth, Clock::kSimulator);
    on<tether_state_t>(channel::kTetherState, &Reader::addTether);
    on<vehicle_state_t>(channel::kVehicleState, &Reader::addVehicle);
    on<command_t>(channel::kCommand, &Reader::addCommand);
    on<mission_status_t>(channel::kMissionStatus, &Reader::addMission);
    on<loop_stats_t>(channel::kLoopStats, &Reader::addLoop);
    on<event_t>(channel::kEvent, &Reader::addEvent);
    on<mission_chunk_t>(channel::kMissionChunk, &Reader::addChunk, Clock::kOther);
    on<params_t>(channel::kParams, &Reader::addParams, Clock::kOther);
    on<station_input_t>(channel::kStationInput, nullptr);
    log_.file = file.string();
  }

  FlightLog read() {
    readMessages();
    alignTimes();
    dropTruthOfAnotherClock();
    return std::move(log_);
  }

 private:
  enum class Clock { kStation, kSimulator, kOther };

  template <class Message>
  void on(const char* name, void (Reader::*add)(const Message&, double t),
          Clock clock = Clock::kStation) {
    handlers_[name] = [this, name, add, clock](const LogEvent& event) {
      ChannelStats& stats = log_.channels[name];
      Message message{};
      if (!version_.fits<Message>(event) ||
          !stringsAreSound(event, static_cast<const Message*>(nullptr)) ||
          message.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0) {
        ++stats.undecodable;
        return;
      }
      ++stats.messages;
      const double t = static_cast<double>(message.utime) * 1e-6;
      stats.times.push_back(t);
      spans_[static_cast<std::size_t>(clock)].include(message.utime);
      if (add != nullptr) (this->*add)(message, t);
    };
  }

  void readMessages() {
    EventLogReader file(file_);
    while (const auto event = file.next()) {
      const auto handler = handlers_.find(event->channel);
      if (handler != handlers_.end()) handler->second(*event);
    }
    version_.check(file_);
    log_.damage = summary(file.damage());
    const UtimeSpan& station = spans_[static_cast<std::size_t>(Clock::kStation)];
    const UtimeSpan& simulator = spans_[static_cast<std::size_t>(Clock::kSimulator)];
    const UtimeSpan& span = station.empty() ? simulator : station;
    if (span.empty()) {
      throw InputError({file_.string(),
                        0,
                        {},
                        "no message of a Tautline station or simulator in this log",
                        "an LCM log with channels such as STATION_STATE, ESTIMATE or SIM_TRUTH",
                        "record one with `tautline log record` while the station runs"});
    }
    log_.start_utime = span.first;
    log_.duration = static_cast<double>(span.last - span.first) * 1e-6;
  }

  // From seconds of the sender's clock to seconds since the first message; sorted, for UDP may swap
  // packets.
  void alignTimes() {
    const double start = static_cast<double>(log_.start_utime) * 1e-6;
    const auto align = [start](auto& series) {
      for (auto& sample : series) sample.t -= start;
      std::stable_sort(series.begin(), series.end(),
                       [](const auto& a, const auto& b) { return a.t < b.t; });
    };
    align(log_.states);
    align(log_.estimates);
    align(log_.truth);
    align(log_.tether);
    align(log_.vehicle);
    align(log_.commands);
    align(log_.mission);
    align(log_.loop);
    align(log_.events);
    for (auto& [name, stats] : log_.channels) {
      for (double& t : stats.times) t -= start;
      std::sort(stats.times.begin(), stats.times.end());
    }
  }

  void dropTruthOfAnotherClock() {
    const auto& states = log_.states;
    auto& truth = log_.truth;
    if (states.empty() || truth.empty()) return;
    if (truth.back().t >= states.front().t && truth.front().t <= states.back().t) return;
    log_.truth_on_other_clock = true;
    truth.clear();
  }

  void addState(const station_state_t& m, double t) {
    log_.states.push_back({t, enumOr(m.run_mode, kRunModeNames, RunMode::kReal),
                           enumOr(m.mode, kModeNames, Mode::kStandby),
                           ConditionSet::fromBits(static_cast<std::uint64_t>(m.reasons)),
                           m.mission_hash});
  }

  void addEstimate(const estimate_t& m, double t) {
    log_.estimates.push_back({t, m.valid != 0 && isFinite(m.position_m),
                              enumOr(m.health, kEstimateHealthNames, EstimateHealth::kLost),
                              vector3(m.position_m), m.tension_n, m.reel_scale});
  }

  void addTruth(const sim_truth_t& m, double t) {
    if (!isFinite(m.position_m) || !isFinite(m.velocity_mps)) return;
    log_.truth.push_back({t, vector3(m.position_m), vector3(m.velocity_mps), m.tension_n,
                          m.length_m, m.reel_scale, m.tangent_elevation_rad, m.tangent_azimuth_rad,
                          m.on_ground != 0, m.motors_on != 0, m.crashed != 0, m.contact_count,
                          vector3(m.anchor_m)});
  }

  void addTether(const tether_state_t& m, double t) {
    log_.tether.push_back({t, m.length_meas_m, m.length_free_m, m.length_static_m, m.elevation_rad,
                           m.azimuth_rad, m.tension_n, m.contact_count, m.contact_id,
                           vector3(m.anchor_m)});
  }

  void addVehicle(const vehicle_state_t& m, double t) {
    log_.vehicle.push_back({t, enumOr(m.phase, kVehiclePhaseNames, VehiclePhase::kUnknown)});
  }

  void addCommand(const command_t& m, double t) {
    log_.commands.push_back(
        {t, m.engaged != 0, m.length_rate_mps, m.elevation_rate_radps, m.azimuth_rate_radps});
  }

  void addMission(const mission_status_t& m, double t) {
    log_.mission.push_back(
        {t, m.mission_hash, enumOr(m.state, kMissionStateNames, MissionState::kIdle),
         enumOr(m.failure, kMissionFailureNames, MissionFailure::kNone), m.waypoint,
         m.waypoint_count, vector3(m.target_m), vector3(m.segment_start_m), m.cross_track_m});
  }

  void addLoop(const loop_stats_t& m, double t) {
    log_.loop.push_back({t, m.period_s, m.cycles, m.overruns, m.skipped_periods, m.lateness_mean_s,
                         m.lateness_max_s, m.work_mean_s, m.work_max_s, m.work_max_ever_s,
                         m.publish_errors, m.commands_refused});
  }

  void addEvent(const event_t& m, double t) {
    log_.events.push_back({t, enumOr(m.severity, kSeverityNames, Severity::kInfo), m.code, m.text,
                           m.reaction, m.remedy});
  }

  void addChunk(const mission_chunk_t& m, double) {
    const bool sound = m.waypoint_total >= 0 && m.waypoint_total <= kMaxWaypoints &&
                       m.contact_total >= 0 && m.contact_total <= kMaxContacts && m.count >= 0 &&
                       m.count <= mission_chunk_t::CAPACITY && m.first >= 0 &&
                       m.first <= kMaxWaypoints;
    if (!sound) return;
    PlannedMission& mission = log_.missions[m.mission_hash];
    mission.waypoints.resize(static_cast<std::size_t>(m.waypoint_total));
    mission.contacts.resize(static_cast<std::size_t>(m.contact_total));
    for (int i = 0; i < m.count; ++i) {
      const auto index = static_cast<std::size_t>(m.first + i);
      if (!isFinite(m.position_m[i])) continue;
      const Eigen::Vector3d p = vector3(m.position_m[i]);
      if (m.kind == 0 && index < mission.waypoints.size())
        mission.waypoints[index] = PlannedWaypoint{p, m.contact_id[i]};
      if (m.kind == 1 && index < mission.contacts.size())
        mission.contacts[index] = PlannedContact{m.contact_id[i], p};
    }
  }

  void addParams(const params_t& m, double) { log_.programs[m.program] = m.version; }

  std::filesystem::path file_;
  FlightLog log_;
  LogVersion version_;
  std::map<std::string, std::function<void(const LogEvent&)>, std::less<>> handlers_;
  std::array<UtimeSpan, 3> spans_{};  // By Clock.
};

}  // namespace

bool PlannedMission::complete() const {
  const auto known = [](const auto& item) { return item.has_value(); };
  return !waypoints.empty() && std::all_of(waypoints.begin(), waypoints.end(), known) &&
         std::all_of(contacts.begin(), contacts.end(), known);
}

FlightLog readFlightLog(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace tautline::report
