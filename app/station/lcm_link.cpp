#include "app/station/lcm_link.h"

#include <tautline/log_status_t.hpp>

#include "app/lcm_access.h"
#include "common/error.h"
#include "lcmtypes/channels.h"

namespace tautline {

LcmLink::LcmLink(const std::string& url) : lcm_(reachable(url)) {
  if (!lcm_.good()) throw cannotJoin(url);
  lcm_t* lcm = lcm_.getUnderlyingLCM();
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm, channel::kOperatorCommand, &LcmLink::onCommand, this), kQueueCapacity);
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm, channel::kMissionChunk, &LcmLink::onChunk, this), kQueueCapacity);
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm, channel::kLogStatus, &LcmLink::onLogStatus, this), kQueueCapacity);
}

bool LcmLink::publish(const char* channel, std::int64_t /*utime*/,
                      std::span<const std::uint8_t> bytes) noexcept {
  // The C function: the C++ one takes a std::string, which would be made anew for each call.
  return lcm_publish(lcm_.getUnderlyingLCM(), channel, bytes.data(),
                     static_cast<unsigned>(bytes.size())) == 0;
}

void LcmLink::poll() noexcept {
  command_.reset();
  chunk_.reset();
  recorder_.reset();
  for (int i = 0; i < kMaxMessagesPerPoll && !command_ && !chunk_; ++i) {
    if (lcm_handle_timeout(lcm_.getUnderlyingLCM(), 0) <= 0) return;
  }
}

void LcmLink::onCommand(const lcm_recv_buf_t* bytes, const char* /*channel*/, void* self) noexcept {
  tautline::operator_command_t m;
  if (m.decode(bytes->data, 0, static_cast<int>(bytes->data_size)) < 0)
    return;  // fixed size: short or foreign bytes are refused
  OperatorCommand command;
  command.session = m.session;
  command.sequence = m.sequence;
  command.request = static_cast<Request>(m.verb);
  command.mission_hash = static_cast<std::uint64_t>(m.mission_hash);
  static_cast<LcmLink*>(self)->command_ = command;
}

void LcmLink::onChunk(const lcm_recv_buf_t* bytes, const char* /*channel*/, void* self) noexcept {
  tautline::mission_chunk_t m;
  if (m.decode(bytes->data, 0, static_cast<int>(bytes->data_size)) < 0) return;
  static_cast<LcmLink*>(self)->chunk_ = m;
}

void LcmLink::onLogStatus(const lcm_recv_buf_t* bytes, const char* /*channel*/,
                          void* self) noexcept {
  tautline::log_status_t m;
  if (m.decode(bytes->data, 0, static_cast<int>(bytes->data_size)) < 0) return;
  static_cast<LcmLink*>(self)->recorder_ =
      RecorderStatus{{}, m.recording != 0, m.disk_free_bytes, m.disk_limit_bytes};
}

}  // namespace tautline
