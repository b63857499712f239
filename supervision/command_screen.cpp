#include "supervision/command_screen.h"

#include <algorithm>

namespace tautline {
namespace {

constexpr Duration kWindow = std::chrono::seconds(30);
constexpr Duration kRepeatAfter = std::chrono::milliseconds(100);
constexpr Duration kForgetAfter = std::chrono::seconds(10);
/// Client times farther than this from any clock would overflow the difference.
constexpr std::int64_t kLargestClock = std::int64_t{1} << 52;  // [us], 140 years

}  // namespace

bool CommandScreen::Allowance::take(Time now, double per_second) noexcept {
  const double earned = started_ ? toSeconds(now - since_) * per_second : per_second;
  left_ = std::min(per_second, left_ + earned);
  since_ = now;
  started_ = true;
  if (left_ < 1.0) return false;
  left_ -= 1.0;
  return true;
}

void CommandScreen::LeastOffset::add(Time now, Duration difference) noexcept {
  if (now - window_began_ >= kWindow) {
    before_ = now - window_began_ < 2 * kWindow ? present_ : Duration::max();
    present_ = Duration::max();
    window_began_ = now;
  }
  present_ = std::min(present_, difference);
}

CommandScreen::Session* CommandScreen::find(std::int64_t session) noexcept {
  for (Session& s : sessions_)
    if (s.id == session) return &s;
  return nullptr;
}

/// A free place, or that of the session silent for longest; none while all of them speak.
CommandScreen::Session* CommandScreen::add(Time now, std::int64_t session) noexcept {
  Session* place = find(0);
  if (place == nullptr) {
    place = std::min_element(sessions_.begin(), sessions_.end(),
                             [](const Session& a, const Session& b) { return a.heard < b.heard; });
    if (now - place->heard < kForgetAfter) return nullptr;
  }
  *place = Session{};
  place->id = session;
  return place;
}

AckResult CommandScreen::look(Time now, OperatorStream stream, const MessageHead& head) noexcept {
  const AckResult result = judge(now, stream, head);
  countRefused(result);
  return result;
}

AckResult CommandScreen::judge(Time now, OperatorStream stream, const MessageHead& head) noexcept {
  if (head.session == 0 || head.sequence <= 0 || head.client_us < -kLargestClock ||
      head.client_us > kLargestClock)
    return AckResult::kMalformed;
  Session* session = find(head.session);
  if (session == nullptr) {
    if (stream != OperatorStream::kHeartbeats) return AckResult::kNoHeartbeat;
    session = add(now, head.session);
    if (session == nullptr) return AckResult::kFlooded;
  }
  std::int64_t& last = session->last_sequence[static_cast<std::size_t>(stream)];
  const bool repeat = stream == OperatorStream::kCommands && head.sequence == last;
  if (head.sequence <= last && !repeat) return AckResult::kReplayed;

  const Duration difference =
      now.time_since_epoch() - Duration(std::chrono::microseconds(head.client_us));
  if (stream == OperatorStream::kHeartbeats) session->offset.add(now, difference);
  if (difference - session->offset.least() > fromSeconds(config_.max_message_age_s))
    return AckResult::kLate;

  if (repeat) {
    if (now - session->last_repeat < kRepeatAfter) return AckResult::kFlooded;
    session->last_repeat = now;
  } else if (stream == OperatorStream::kCommands &&
             !session->allowance.take(now, config_.max_messages_per_s)) {
    return AckResult::kFlooded;
  }
  last = head.sequence;
  session->heard = now;
  return AckResult::kAccepted;
}

}  // namespace tautline
