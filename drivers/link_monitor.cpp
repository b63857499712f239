#include "drivers/link_monitor.h"

namespace tautline {
namespace {

constexpr double kTextShare = 0.95;  // noise has about a third

}  // namespace

LinkFault LinkMonitor::update(Time now, const LinkTraffic& total) noexcept {
  const bool nothing_understood = fault_ == LinkFault::kSilent || fault_ == LinkFault::kGarbage ||
                                  fault_ == LinkFault::kOtherProtocol;
  const bool heard = nothing_understood && total.good != at_start_.good;
  if (!started_ || !total.connected || !at_start_.connected || heard) {
    started_ = true;
    fault_ = LinkFault::kNone;
  } else if (now - window_start_ >= window_) {
    fault_ = judge(total);
  } else {
    return fault_;
  }
  window_start_ = now;
  at_start_ = total;
  return fault_;
}

LinkFault LinkMonitor::judge(const LinkTraffic& total) const noexcept {
  const std::uint32_t good = total.good - at_start_.good;
  const std::uint32_t bad = total.bad - at_start_.bad;
  if (good > 0) return bad >= good ? LinkFault::kUnreliable : LinkFault::kNone;
  const std::uint64_t bytes = total.bytes - at_start_.bytes;
  const std::uint64_t text = total.text_bytes - at_start_.text_bytes;
  if (total.foreign != at_start_.foreign) return LinkFault::kOtherProtocol;
  if (bytes == 0) return LinkFault::kSilent;
  const bool is_text = static_cast<double>(text) >= kTextShare * static_cast<double>(bytes);
  return is_text ? LinkFault::kOtherProtocol : LinkFault::kGarbage;
}

}  // namespace tautline
