#include "app/station/lcm_link.h"

#include <tautline/log_status_t.hpp>

#include "common/error.h"
#include "lcmtypes/channels.h"
#include "lcmtypes/lcm_access.h"

namespace tautline {

LcmLink::LcmLink(const std::string& url, const AuthorityConfig& authority)
    : lcm_(reachable(url)), inbox_(authority) {
  if (!lcm_.good()) throw cannotJoin(url);
  subscribe<&OperatorInbox::command>(channel::kOperatorCommand);
  subscribe<&OperatorInbox::chunk>(channel::kMissionChunk);
  subscribe<&OperatorInbox::heartbeat>(channel::kHeartbeat);
  subscribe<&OperatorInbox::sticks>(channel::kTeleop);
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm_.getUnderlyingLCM(), channel::kLogStatus, &LcmLink::onLogStatus, this),
      kQueueCapacity);
}

template <void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept>
void LcmLink::subscribe(const char* channel) {
  lcm_subscription_set_queue_capacity(
      lcm_subscribe(lcm_.getUnderlyingLCM(), channel, &LcmLink::on<take>, this), kQueueCapacity);
}

template <void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept>
void LcmLink::on(const lcm_recv_buf_t* bytes, const char* /*channel*/, void* self) noexcept {
  (static_cast<LcmLink*>(self)->inbox_.*
   take)({static_cast<const std::uint8_t*>(bytes->data), bytes->data_size});
}

bool LcmLink::publish(const char* channel, std::int64_t /*utime*/,
                      std::span<const std::uint8_t> bytes) noexcept {
  // The C function: the C++ one takes a std::string, which would be made anew for each call.
  return lcm_publish(lcm_.getUnderlyingLCM(), channel, bytes.data(),
                     static_cast<unsigned>(bytes.size())) == 0;
}

void LcmLink::poll(Time now, std::int64_t holder) noexcept {
  inbox_.beginCycle(now, holder);
  recorder_.reset();
  for (int i = 0; i < kMaxMessagesPerPoll; ++i)
    if (lcm_handle_timeout(lcm_.getUnderlyingLCM(), 0) <= 0) return;
  inbox_.overflowed();
}

void LcmLink::onLogStatus(const lcm_recv_buf_t* bytes, const char* /*channel*/,
                          void* self) noexcept {
  tautline::log_status_t m;
  if (m.decode(bytes->data, 0, static_cast<int>(bytes->data_size)) < 0) return;
  static_cast<LcmLink*>(self)->recorder_ =
      RecorderStatus{{}, m.recording != 0, m.disk_free_bytes, m.disk_limit_bytes};
}

}  // namespace tautline
