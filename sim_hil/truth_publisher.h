#pragma once

/// @file
/// SIM_TRUTH and PARAMS over LCM. Without LCM, or without a way for its packets, nothing is sent
/// and one line says what to do.

#include <cstdint>
#include <memory>
#include <string>

#include "sim_hil/truth.h"

namespace lcm {
class LCM;
}

namespace tautline::sim {

class TruthPublisher {
 public:
  /// An empty `url` sends nothing. Not real-time safe: start-up only.
  TruthPublisher(const std::string& url, std::string effective_config);
  ~TruthPublisher();

  /// Empty if all is well or nothing is to be sent; else one line for the user.
  [[nodiscard]] const std::string& warning() const noexcept { return warning_; }

  void publishTruth(const Truth& truth, std::int64_t utime);
  void publishParams(std::int64_t utime);

 private:
  std::unique_ptr<lcm::LCM> lcm_;
  std::string effective_config_;
  std::string warning_;
};

}  // namespace tautline::sim
