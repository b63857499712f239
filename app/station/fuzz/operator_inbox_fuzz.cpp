/// @file
/// Any bytes as messages of operators, through the real decoding, screen and authority. The input
/// is a row of records: kind (0…3: command, mission piece, heartbeat, sticks; 4: wait), how it is
/// to be changed, size of what follows (two bytes), bytes. With change 1 the fingerprint of the
/// kind is put before the bytes and they are filled up to its size, so that random bytes get past
/// the decoder; with change 2 the head is made one that the screen lets pass.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "app/station/operator_inbox.h"
#include "app/station/operator_message.h"
#include "app/station/station.h"
#include "common/error.h"

namespace tautline {
namespace {

template <class Message>
void makeDecodable(std::vector<std::uint8_t>& bytes) {
  Message m{};
  std::vector<std::uint8_t> good(static_cast<std::size_t>(m.getEncodedSize()));
  m.encode(good.data(), 0, static_cast<int>(good.size()));
  constexpr std::size_t kFingerprint = 8;
  for (std::size_t i = 0; kFingerprint + i < good.size() && i < bytes.size(); ++i)
    good[kFingerprint + i] = bytes[i];
  bytes = good;
}

template <class Message>
void makeFresh(std::vector<std::uint8_t>& bytes, Time now, std::int64_t sequence) {
  Message m{};
  if (m.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) return;
  m.utime = toMicroseconds(now);
  m.session = 1 + (m.session & 3);
  m.sequence = sequence;
  m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
}

/// One of four operators' programs, in the order of the kinds.
struct Kind {
  void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept;
  void (*make_decodable)(std::vector<std::uint8_t>&);
  void (*make_fresh)(std::vector<std::uint8_t>&, Time, std::int64_t);
};
template <class Message>
constexpr Kind kindOf(void (OperatorInbox::*take)(std::span<const std::uint8_t>) noexcept) {
  return {take, makeDecodable<Message>, makeFresh<Message>};
}
constexpr std::array kKinds{kindOf<operator_command_t>(&OperatorInbox::command),
                            kindOf<mission_chunk_t>(&OperatorInbox::chunk),
                            kindOf<heartbeat_t>(&OperatorInbox::heartbeat),
                            kindOf<teleop_t>(&OperatorInbox::sticks)};

std::int64_t total(const AckCounts& counts) {
  std::int64_t sum = 0;
  for (const std::int64_t n : counts) sum += n;
  return sum;
}

}  // namespace
}  // namespace tautline

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tautline;
  CoreConfig config;
  OperatorInbox inbox(config.authority);
  const auto missions = std::make_unique<MissionStore>();
  const auto operators = std::make_unique<OperatorDialogue>(config, *missions);
  Time now{std::chrono::seconds(100)};
  std::int64_t sequence = 0;
  std::int64_t messages = 0;

  const auto cycle = [&] {
    StepInput in;
    now += std::chrono::milliseconds(10);
    in.now = now;
    inbox.fill(in);
    const Request request = operators->take(in, Mode::kStandby);
    SupervisorOutput refused;
    operators->answer(now, refused);
    // Nothing gets through that was not sent, by nobody in particular, or without being told.
    TAUTLINE_CHECK(request <= Request::kEstop);
    TAUTLINE_CHECK(request == Request::kNone || (in.command && in.command->request == request));
    TAUTLINE_CHECK(!in.command || operators->ack());
    TAUTLINE_CHECK(!in.command || in.chunk == nullptr);
    const auto rates = operators->authority().rates(now);
    TAUTLINE_CHECK(!rates || std::isfinite(rates->length + rates->elevation + rates->azimuth));
    TAUTLINE_CHECK(operators->authority().lease().name.back() == 0);
    inbox.beginCycle(now, operators->authority().lease().session);
  };

  inbox.beginCycle(now, 0);
  while (size >= 4) {
    const std::uint8_t kind = data[0];
    const std::uint8_t change = data[1];
    const std::size_t wanted =
        static_cast<std::size_t>(data[2]) | (static_cast<std::size_t>(data[3]) << 8);
    data += 4;
    size -= 4;
    const std::size_t count = std::min(wanted, size);
    std::vector<std::uint8_t> bytes(data, data + count);
    data += count;
    size -= count;
    if (kind >= kKinds.size()) {
      cycle();
      continue;
    }
    const Kind& k = kKinds[kind];
    if ((change & 3) != 0) k.make_decodable(bytes);
    if ((change & 2) != 0) k.make_fresh(bytes, now, ++sequence);
    const std::int64_t before = total(inbox.counts());
    (inbox.*k.take)(bytes);
    ++messages;
    TAUTLINE_CHECK(total(inbox.counts()) > before);  // every message is accounted for
    if ((change & 4) == 0) cycle();
  }
  cycle();
  TAUTLINE_CHECK(total(inbox.counts()) >= messages);
  return 0;
}
