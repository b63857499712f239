#pragma once

/// @file
/// The station's state as LCM messages. Encoding happens in buffers made at start-up and the sink
/// gets finished bytes: the typed publish of LCM would allocate in every call.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tautline/authority_t.hpp>
#include <tautline/command_ack_t.hpp>
#include <tautline/command_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/faults_t.hpp>
#include <tautline/loop_stats_t.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/params_t.hpp>
#include <tautline/safety_t.hpp>
#include <tautline/station_input_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>
#include <tautline/vehicle_state_t.hpp>

#include "app/station/station.h"
#include "common/loop_timer.h"

namespace tautline {

/// Where encoded messages go: the network, or a log file.
class TelemetrySink {
 public:
  TelemetrySink() = default;
  TelemetrySink(const TelemetrySink&) = delete;
  TelemetrySink& operator=(const TelemetrySink&) = delete;
  virtual ~TelemetrySink() = default;

  /// @param utime as in the message [us]. Returns false if the message could not be handed on;
  /// never throws, never blocks for long.
  virtual bool publish(const char* channel, std::int64_t utime,
                       std::span<const std::uint8_t> bytes) noexcept = 0;
};

/// Turns cycles into messages. All but the constructor and setParams() are real-time safe: no
/// allocation, no locks, no exceptions (as far as the sink is).
class Telemetry {
 public:
  /// @param unix_offset what to add to the loop's clock to get `utime`.
  /// @param state_period how often state messages are published; STATION_INPUT goes out every
  /// cycle.
  Telemetry(TelemetrySink& sink, RunMode run_mode, Duration unix_offset, Duration state_period);

  /// After each step: inputs, state at its rate, and at once acknowledgements, events and actions.
  void publish(const StepInput& in, const StepOutput& out) noexcept;

  /// Once a second.
  void publishLoop(Time now, Duration period, const LoopStatistics::Snapshot& s) noexcept;

  /// Messages refused before the core saw them, to be told with its own refusals; `counts` outlives
  /// the telemetry.
  void addRefusalsOf(const AckCounts& counts) noexcept { inbox_counts_ = &counts; }

  /// What publishParams() says. Not real-time safe: start-up only.
  void setParams(const std::string& program, const std::string& version, const std::string& toml);

  /// Serial device, CAN interface or recording, for VEHICLE_STATE and the texts of events. Not
  /// real-time safe: start-up only.
  void setPlace(const std::string& place);

  /// The effective configuration, at start and now and then, so that a log that began late has it
  /// too.
  void publishParams(Time now) noexcept;

  [[nodiscard]] std::int64_t errors() const noexcept { return errors_; }

 private:
  template <class Message>
  void send(const char* channel, Message& message, Time now,
            std::span<std::uint8_t> buffer) noexcept {
    message.utime = unixMicroseconds(now);
    const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
    if (size < 0 ||
        !sink_.publish(channel, message.utime, buffer.first(static_cast<std::size_t>(size))))
      ++errors_;
  }
  template <class Message>
  void send(const char* channel, Message& message, Time now) noexcept {
    send(channel, message, now, buffer_);
  }
  void sendInput(const StepInput& in) noexcept;
  void sendStation(Time now, const StepOutput& out) noexcept;
  void sendSafety(Time now, const StepOutput& out) noexcept;
  void sendTether(const StepInput& in, const StepOutput& out) noexcept;
  void sendVehicle(const StepInput& in) noexcept;
  void sendEstimate(Time now, const StepOutput& out) noexcept;
  void sendCommand(Time now, const VehicleCommand& command) noexcept;
  void sendMission(Time now, const StepOutput& out) noexcept;
  void sendEvent(Time now, const StationEvent& event) noexcept;
  void sendCondition(Time now, const StationEvent& event) noexcept;
  void sendText(Time now, EventCode code) noexcept;

  // In operator_telemetry.cpp: what operators are told of their own dealings.
  void publishOperators(const StepInput& in, const StepOutput& out) noexcept;
  void sendAudit(Time now, const AuditRecord& audit) noexcept;
  void sendLeaseChange(Time now, const LeaseChange& change) noexcept;
  void sendParameterChange(Time now, const ParameterChange& change,
                           const OperatorName& name) noexcept;
  void sendAuthority(Time now, const OperatorDialogue& operators) noexcept;
  void sendFaults(Time now, const FaultLog& faults) noexcept;
  void patchParams(const ParameterChange& change) noexcept;
  [[nodiscard]] std::int64_t unixMicroseconds(Time t) const noexcept {
    return toMicroseconds(t + unix_offset_);
  }

  TelemetrySink& sink_;
  RunMode run_mode_;
  Duration unix_offset_;
  Duration state_period_;
  Time next_state_{};
  Time next_authority_{};
  Time next_faults_{};
  Time next_safety_{};
  ConditionSet safety_told_;
  bool fault_was_latched_{false};
  std::size_t faults_told_{0};
  const AckCounts* inbox_counts_{nullptr};
  std::int64_t refused_{0};
  std::int64_t errors_{0};
  std::array<std::uint8_t, 4096> buffer_{};

  tautline::event_t event_{};            ///< Member, with its strings reserved.
  tautline::vehicle_state_t vehicle_{};  ///< Member, with its string made by setPlace().
  tautline::params_t params_{};  ///< Member, with its strings and its buffer made by setParams().
  std::vector<std::uint8_t> params_buffer_;
};

}  // namespace tautline
