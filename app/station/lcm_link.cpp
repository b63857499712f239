#include "app/station/lcm_link.h"

#include "app/lcm_access.h"
#include "common/error.h"
#include "lcmtypes/channels.h"

namespace tautline {

LcmLink::LcmLink(const std::string& url) : lcm_(reachable(url)) {
  if (!lcm_.good()) throw cannotJoin(url);
  lcm_.subscribe(channel::kOperatorCommand, &LcmLink::onCommand, this)
      ->setQueueCapacity(kQueueCapacity);
  lcm_.subscribe(channel::kMissionChunk, &LcmLink::onChunk, this)->setQueueCapacity(kQueueCapacity);
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
  for (int i = 0; i < kMaxMessagesPerPoll && !command_ && !chunk_; ++i) {
    if (lcm_.handleTimeout(0) <= 0) return;
  }
}

void LcmLink::onCommand(const lcm::ReceiveBuffer*, const std::string&,
                        const tautline::operator_command_t* m) {
  OperatorCommand command;
  command.session = m->session;
  command.sequence = m->sequence;
  command.request = static_cast<Request>(m->verb);
  command.mission_hash = static_cast<std::uint64_t>(m->mission_hash);
  command_ = command;
}

void LcmLink::onChunk(const lcm::ReceiveBuffer*, const std::string&,
                      const tautline::mission_chunk_t* m) {
  chunk_ = *m;
}

}  // namespace tautline
