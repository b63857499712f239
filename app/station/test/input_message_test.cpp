#include "app/station/input_message.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tautline {
namespace {

std::vector<std::uint8_t> bytesOf(const tautline::station_input_t& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// A message with something else in every field: random bytes decoded, flags made 0 or 1,
/// enumerations and small integers kept in the range of what they stand for.
tautline::station_input_t randomMessage(std::mt19937_64& random) {
  const tautline::station_input_t empty{};
  std::vector<std::uint8_t> bytes = bytesOf(empty);
  for (std::size_t i = 8; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(random() & 0x3f);
  tautline::station_input_t m{};
  m.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  m.utime = 0;
  m.chunk_session = 0;
  m.chunk_sequence = 0;  // a chunk itself is not in the message
  m.has_command = 1;
  m.command_verb = static_cast<std::int8_t>(random() % 12);
  m.command_service = static_cast<std::int8_t>(random() % 6);
  m.has_heartbeat = 1;
  m.has_sticks = 1;
  m.has_turned_away = 1;
  m.turned_away_result = static_cast<std::int8_t>(random() % kAckResultNames.size());
  for (auto* name : {&m.command_name, &m.heartbeat_name}) put(*name, operatorName("anna@bench"));
  for (std::int8_t* flag : {&m.sticks_dead_man, &m.reel_valid, &m.angles_valid, &m.attitude_valid,
                            &m.gimbal_valid, &m.vehicle_valid, &m.ground_valid, &m.link_connected,
                            &m.real_time, &m.clock_synchronized, &m.recorder_recording}) {
    *flag = static_cast<std::int8_t>(random() % 2);
  }
  m.reel_has_tension = 1;
  m.has_altitude = 1;
  m.recorder_heard = 1;
  m.run_mode = static_cast<std::int8_t>(random() % 3);
  m.device_reality = static_cast<std::int8_t>(random() % 3);
  m.vehicle_protocol = static_cast<std::int8_t>(random() % 3);
  m.link_fault = static_cast<std::int8_t>(random() % kLinkFaultNames.size());
  m.vehicle_phase = static_cast<std::int8_t>(random() % 6);
  m.flight_mode = static_cast<std::int16_t>(random() % 256);
  m.ground_mode = static_cast<std::int16_t>(random() % 256);
  m.vehicle_flags = static_cast<std::int32_t>(random() % 65536);
  return m;
}

TEST(InputMessage, ComesBackAsItWent) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const tautline::station_input_t sent = randomMessage(random);
    EXPECT_EQ(bytesOf(messageOf(inputOf(sent))), bytesOf(sent));
  }
}

TEST(InputMessage, AbsentValuesStayAbsent) {
  const StepInput in = inputOf(messageOf(StepInput{}));
  EXPECT_FALSE(in.command.has_value());
  EXPECT_FALSE(in.sensors.reel.value.tension.has_value());
  EXPECT_FALSE(in.sensors.angles.value.altitude.has_value());
  EXPECT_FALSE(in.host.recorder.has_value());
  EXPECT_EQ(in.sensors.reel.sequence, 0U);
}

}  // namespace
}  // namespace tautline
