#include "app/station/input_message.h"

#include <optional>

namespace tautline {
namespace {

template <class T>
std::int64_t nanosecondsOf(const Sample<T>& sample) noexcept {
  return sample.time.time_since_epoch().count();
}

Time timeOf(std::int64_t ns) noexcept { return Time(Duration(ns)); }

template <class T>
void fill(Sample<T>& sample, std::int64_t time_ns, std::int32_t sequence, bool valid) noexcept {
  sample.time = timeOf(time_ns);
  sample.sequence = static_cast<std::uint32_t>(sequence);
  sample.valid = valid;
}

std::optional<double> optional(bool has, double value) noexcept {
  return has ? std::optional(value) : std::nullopt;
}

template <class Int, class T>
Int as(T value) noexcept {
  return static_cast<Int>(value);
}

}  // namespace

tautline::station_input_t messageOf(const StepInput& in) noexcept {
  const SensorFrame& f = in.sensors;
  tautline::station_input_t m{};
  m.now_ns = in.now.time_since_epoch().count();
  m.has_command = in.command ? 1 : 0;
  if (in.command) {
    m.command_session = in.command->session;
    m.command_sequence = in.command->sequence;
    put(m.command_name, in.command->name);
    m.command_verb = as<std::int8_t>(in.command->request);
    m.command_service = as<std::int8_t>(in.command->service);
    m.command_mission_hash = as<std::int64_t>(in.command->mission_hash);
    m.command_parameter = as<std::int64_t>(in.command->parameter);
    m.command_value = in.command->value;
  }
  m.chunk_session = in.chunk != nullptr ? in.chunk->session : 0;
  m.chunk_sequence = in.chunk != nullptr ? in.chunk->sequence : 0;
  m.has_heartbeat = in.heartbeat ? 1 : 0;
  if (in.heartbeat) {
    m.heartbeat_session = in.heartbeat->session;
    put(m.heartbeat_name, in.heartbeat->name);
  }
  m.has_sticks = in.sticks ? 1 : 0;
  if (in.sticks) {
    const TeleopRates& rates = in.sticks->rates;
    m.sticks_session = in.sticks->session;
    m.sticks_dead_man = in.sticks->dead_man;
    m.sticks_length_rate_mps = rates.length;
    m.sticks_elevation_rate_radps = rates.elevation;
    m.sticks_azimuth_rate_radps = rates.azimuth;
    m.sticks_yaw_rate_radps = rates.yaw;
    m.sticks_gimbal_pitch_rate_radps = rates.gimbal_pitch;
  }
  m.has_turned_away = in.turned_away ? 1 : 0;
  if (in.turned_away) {
    m.turned_away_session = in.turned_away->session;
    m.turned_away_sequence = in.turned_away->sequence;
    m.turned_away_result = as<std::int8_t>(in.turned_away->result);
  }
  m.loop_overruns = in.missed_in_a_row;

  m.reel_time_ns = nanosecondsOf(f.reel);
  m.reel_sequence = as<std::int32_t>(f.reel.sequence);
  m.reel_valid = f.reel.valid;
  m.reel_counts = f.reel.value.counts;
  m.reel_length_m = f.reel.value.length;
  m.reel_has_tension = f.reel.value.tension.has_value();
  m.reel_tension_n = f.reel.value.tension.value_or(0.0);

  m.angles_time_ns = nanosecondsOf(f.angles);
  m.angles_sequence = as<std::int32_t>(f.angles.sequence);
  m.angles_valid = f.angles.valid;
  m.elevation_rad = f.angles.value.theta;
  m.azimuth_rad = f.angles.value.phi;
  m.has_altitude = f.angles.value.altitude.has_value();
  m.altitude_m = f.angles.value.altitude.value_or(0.0);

  m.attitude_time_ns = nanosecondsOf(f.attitude);
  m.attitude_sequence = as<std::int32_t>(f.attitude.sequence);
  m.attitude_valid = f.attitude.valid;
  put(m.attitude_wxyz, f.attitude.value.R_WB);

  m.gimbal_time_ns = nanosecondsOf(f.gimbal);
  m.gimbal_sequence = as<std::int32_t>(f.gimbal.sequence);
  m.gimbal_valid = f.gimbal.valid;
  m.gimbal_pitch_rad = f.gimbal.value.pitch;

  m.vehicle_time_ns = nanosecondsOf(f.vehicle);
  m.vehicle_sequence = as<std::int32_t>(f.vehicle.sequence);
  m.vehicle_valid = f.vehicle.valid;
  m.vehicle_phase = as<std::int8_t>(f.vehicle.value.phase);
  m.flight_mode = f.vehicle.value.flight_mode;
  m.vehicle_flags = f.vehicle.value.flags;
  m.backup_battery_v = f.vehicle.value.backup_battery_voltage;

  m.ground_time_ns = nanosecondsOf(f.ground);
  m.ground_sequence = as<std::int32_t>(f.ground.sequence);
  m.ground_valid = f.ground.valid;
  m.ground_mode = f.ground.value.mode;
  m.ground_battery_v = f.ground.value.battery_voltage;

  putLink(m, f.link);
  return m;
}

StepInput inputOf(const tautline::station_input_t& m) noexcept {
  StepInput in;
  in.now = timeOf(m.now_ns);
  in.missed_in_a_row = m.loop_overruns;
  if (m.has_command) {
    in.command = OperatorCommand{.session = m.command_session,
                                 .sequence = m.command_sequence,
                                 .request = static_cast<Request>(m.command_verb),
                                 .mission_hash = as<std::uint64_t>(m.command_mission_hash),
                                 .service = static_cast<Service>(m.command_service),
                                 .parameter = as<std::uint64_t>(m.command_parameter),
                                 .value = m.command_value,
                                 .name = nameFromBytes(m.command_name)};
  }
  if (m.has_heartbeat)
    in.heartbeat = Heartbeat{m.heartbeat_session, nameFromBytes(m.heartbeat_name)};
  if (m.has_sticks) {
    in.sticks = Sticks{
        m.sticks_session,
        m.sticks_dead_man != 0,
        {m.sticks_length_rate_mps, m.sticks_elevation_rate_radps, m.sticks_azimuth_rate_radps,
         m.sticks_yaw_rate_radps, m.sticks_gimbal_pitch_rate_radps}};
  }
  if (m.has_turned_away) {
    in.turned_away = TurnedAway{m.turned_away_session, m.turned_away_sequence,
                                static_cast<AckResult>(m.turned_away_result)};
  }
  SensorFrame& f = in.sensors;
  fill(f.reel, m.reel_time_ns, m.reel_sequence, m.reel_valid);
  f.reel.value = {m.reel_counts, m.reel_length_m, optional(m.reel_has_tension, m.reel_tension_n)};
  fill(f.angles, m.angles_time_ns, m.angles_sequence, m.angles_valid);
  f.angles.value = {m.elevation_rad, m.azimuth_rad, optional(m.has_altitude, m.altitude_m)};
  fill(f.attitude, m.attitude_time_ns, m.attitude_sequence, m.attitude_valid);
  const double(&q)[4] = m.attitude_wxyz;
  f.attitude.value.R_WB = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  fill(f.gimbal, m.gimbal_time_ns, m.gimbal_sequence, m.gimbal_valid);
  f.gimbal.value.pitch = m.gimbal_pitch_rad;
  fill(f.vehicle, m.vehicle_time_ns, m.vehicle_sequence, m.vehicle_valid);
  f.vehicle.value = {static_cast<VehiclePhase>(m.vehicle_phase),
                     static_cast<std::uint8_t>(m.flight_mode),
                     static_cast<std::uint16_t>(m.vehicle_flags), m.backup_battery_v};
  fill(f.ground, m.ground_time_ns, m.ground_sequence, m.ground_valid);
  f.ground.value = {static_cast<std::uint8_t>(m.ground_mode), m.ground_battery_v};
  f.link = {m.link_connected != 0,
            static_cast<std::uint64_t>(m.link_bytes_in),
            static_cast<std::uint64_t>(m.link_bytes_out),
            static_cast<std::uint32_t>(m.link_lines_ok),
            static_cast<std::uint32_t>(m.link_lines_bad),
            static_cast<std::uint32_t>(m.link_bytes_dropped),
            static_cast<std::uint32_t>(m.link_reconnects),
            static_cast<LinkFault>(m.link_fault),
            static_cast<std::uint32_t>(m.link_repeated),
            static_cast<std::uint32_t>(m.link_wrong_sequence),
            static_cast<std::uint32_t>(m.link_check_errors),
            static_cast<std::uint32_t>(m.link_timeouts),
            static_cast<std::uint32_t>(m.link_bus_errors),
            static_cast<std::uint32_t>(m.link_bus_off)};
  return in;
}

}  // namespace tautline
