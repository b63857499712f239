#include "sim_hil/truth_publisher.h"

#include <utility>

#include <lcm/lcm-cpp.hpp>
#include <tautline/params_t.hpp>
#include <tautline/sim_truth_t.hpp>

#include "common/multicast.h"
#include "lcmtypes/channels.h"

namespace tautline::sim {

TruthPublisher::TruthPublisher(const std::string& url, std::string effective_config)
    : effective_config_(std::move(effective_config)) {
  if (url.empty()) return;
  if (hasMulticastRoute(url)) {
    lcm_ = std::make_unique<lcm::LCM>(url);
    if (lcm_->good()) return;
    lcm_.reset();
  }
  warning_ = "no LCM at " + url + ", going on without SIM_TRUTH; " + kMulticastRemedy;
}

TruthPublisher::~TruthPublisher() = default;

void TruthPublisher::publishTruth(const Truth& truth, std::int64_t utime) {
  if (!lcm_) return;
  sim_truth_t message;
  fillTruth(truth, utime, message);
  lcm_->publish(channel::kSimTruth, &message);
}

void TruthPublisher::publishParams(std::int64_t utime) {
  if (!lcm_) return;
  params_t message;
  message.utime = utime;
  message.program = "tautline-sim";
  message.version = TAUTLINE_VERSION;
  message.toml = effective_config_;
  lcm_->publish(channel::kParams, &message);
}

}  // namespace tautline::sim
