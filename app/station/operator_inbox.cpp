#include "app/station/operator_inbox.h"

#include "app/station/operator_message.h"
#include "supervision/authority.h"

namespace tautline {
namespace {

constexpr int kChunkRank = 1;

int rankOf(const OperatorCommand& c) noexcept {
  if (c.request == Request::kEstop) return 4;
  return isSafeDirection(c.request) ? 3 : 2;
}

template <class Message>
std::optional<Message> decoded(std::span<const std::uint8_t> bytes) noexcept {
  return decodeExactly<Message>(bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace

void OperatorInbox::beginCycle(Time now, std::int64_t holder) noexcept {
  now_ = now;
  holder_ = holder;
  rank_ = 0;
  command_.reset();
  chunk_.reset();
  heartbeat_.reset();
  sticks_.reset();
  turned_away_.reset();
}

bool OperatorInbox::passes(OperatorStream stream, const MessageHead& head) noexcept {
  const AckResult result = screen_.look(now_, stream, head);
  if (result == AckResult::kAccepted) return true;
  if (stream == OperatorStream::kCommands && !turned_away_ && screen_.mayAnswer(now_))
    turned_away_ = TurnedAway{head.session, head.sequence, result};
  return false;
}

bool OperatorInbox::outranks(int rank) noexcept {
  if (rank_ != 0) screen_.countRefused(AckResult::kFlooded);
  if (rank <= rank_) return false;
  rank_ = rank;
  command_.reset();
  chunk_.reset();
  return true;
}

void OperatorInbox::command(std::span<const std::uint8_t> bytes) noexcept {
  const auto m = decoded<tautline::operator_command_t>(bytes);
  if (!m) return screen_.countRefused(AckResult::kMalformed);
  if (!passes(OperatorStream::kCommands, headOf(*m))) return;
  const OperatorCommand command = commandOf(*m);
  if (outranks(rankOf(command))) command_ = command;
}

void OperatorInbox::chunk(std::span<const std::uint8_t> bytes) noexcept {
  const auto m = decoded<tautline::mission_chunk_t>(bytes);
  if (!m) return screen_.countRefused(AckResult::kMalformed);
  if (passes(OperatorStream::kCommands, headOf(*m)) && outranks(kChunkRank)) chunk_ = *m;
}

void OperatorInbox::heartbeat(std::span<const std::uint8_t> bytes) noexcept {
  const auto m = decoded<tautline::heartbeat_t>(bytes);
  if (!m) return screen_.countRefused(AckResult::kMalformed);
  if (passes(OperatorStream::kHeartbeats, headOf(*m)) && m->session == holder_)
    heartbeat_ = Heartbeat{m->session, nameFromBytes(m->name)};
}

void OperatorInbox::sticks(std::span<const std::uint8_t> bytes) noexcept {
  const auto m = decoded<tautline::teleop_t>(bytes);
  const auto sticks = m ? sticksOf(*m) : std::nullopt;
  if (!sticks) return screen_.countRefused(AckResult::kMalformed);
  if (!passes(OperatorStream::kSticks, headOf(*m))) return;
  if (sticks->session != holder_) return screen_.countRefused(AckResult::kNotHolder);
  sticks_ = sticks;
}

void OperatorInbox::fill(StepInput& in) const noexcept {
  in.command = command_;
  in.chunk = chunk_ ? &*chunk_ : nullptr;
  in.heartbeat = heartbeat_;
  in.sticks = sticks_;
  in.turned_away = turned_away_;
}

}  // namespace tautline
