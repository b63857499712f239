#pragma once

/// @file
/// The station's side of LCM: publishes finished bytes, takes commands and missions in without ever
/// waiting.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <lcm/lcm-cpp.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/operator_command_t.hpp>

#include "app/station/operator_command.h"
#include "app/station/telemetry.h"
#include "supervision/detect/host_watch.h"

namespace tautline {

class LcmLink final : public TelemetrySink {
 public:
  /// Joins LCM and subscribes; LCM's own reader thread starts here, so construct it before raising
  /// the loop's priority.
  /// @throws InputError (exit code kTimeout) with the command that mends it. Not real-time safe:
  /// start-up only.
  explicit LcmLink(const std::string& url);

  bool publish(const char* channel, std::int64_t utime,
               std::span<const std::uint8_t> bytes) noexcept override;

  /// Handles what has arrived until there is something for the core, at most a few messages. Never
  /// waits, never throws.
  void poll() noexcept;

  /// What the last poll() brought; at most one of the two.
  [[nodiscard]] const std::optional<OperatorCommand>& command() const noexcept { return command_; }
  [[nodiscard]] const tautline::mission_chunk_t* chunk() const noexcept {
    return chunk_ ? &*chunk_ : nullptr;
  }
  /// What a recorder said, if it did since the poll() before; `heard` is left to the caller.
  [[nodiscard]] const std::optional<RecorderStatus>& recorder() const noexcept { return recorder_; }

 private:
  // Raw handlers of the C library: the C++ one makes a std::string of the channel for every
  // message.
  static void onCommand(const lcm_recv_buf_t* bytes, const char* channel, void* self) noexcept;
  static void onChunk(const lcm_recv_buf_t* bytes, const char* channel, void* self) noexcept;

  static void onLogStatus(const lcm_recv_buf_t* bytes, const char* channel, void* self) noexcept;

  static constexpr int kMaxMessagesPerPoll = 8;
  static constexpr int kQueueCapacity = 64;

  lcm::LCM lcm_;
  std::optional<OperatorCommand> command_;
  std::optional<tautline::mission_chunk_t> chunk_;
  std::optional<RecorderStatus> recorder_;
};

}  // namespace tautline
