#pragma once

/// @file
/// The station's side of LCM: publishes finished bytes, takes what operators send in without ever
/// waiting.

#include <cstdint>
#include <span>
#include <string>

#include <lcm/lcm-cpp.hpp>

#include "app/station/operator_inbox.h"
#include "app/station/telemetry.h"
#include "supervision/detect/host_watch.h"

namespace tautline {

class LcmLink final : public TelemetrySink {
 public:
  /// Joins LCM and subscribes; LCM's own reader thread starts here, so construct it before raising
  /// the loop's priority.
  /// @throws InputError (exit code kTimeout) with the command that mends it. Not real-time safe:
  /// start-up only.
  explicit LcmLink(const std::string& url, const AuthorityConfig& authority = {});

  bool publish(const char* channel, std::int64_t utime,
               std::span<const std::uint8_t> bytes) noexcept override;

  /// Puts what has arrived into the inbox, at most kMaxMessagesPerPoll messages. Never waits, never
  /// throws.
  /// @param holder session that holds the lease, 0: none.
  void poll(Time now, std::int64_t holder) noexcept;

  /// What the last poll() brought.
  [[nodiscard]] const OperatorInbox& inbox() const noexcept { return inbox_; }
  /// What a recorder said, if it did since the poll() before; `heard` is left to the caller.
  [[nodiscard]] const std::optional<RecorderStatus>& recorder() const noexcept { return recorder_; }

 private:
  // A raw handler of the C library: the C++ one makes a std::string of the channel for every
  // message.
  template <void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept>
  static void on(const lcm_recv_buf_t* bytes, const char* channel, void* self) noexcept;
  template <void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept>
  void subscribe(const char* channel);

  static void onLogStatus(const lcm_recv_buf_t* bytes, const char* channel, void* self) noexcept;

  /// A flood of 10,000 messages a second is read as it comes by a loop of 100 Hz.
  static constexpr int kMaxMessagesPerPoll = 128;
  static constexpr int kQueueCapacity = 128;  ///< For each channel.

  lcm::LCM lcm_;
  OperatorInbox inbox_;
  std::optional<RecorderStatus> recorder_;
};

}  // namespace tautline
