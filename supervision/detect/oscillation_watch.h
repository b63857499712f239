#pragma once

/// @file
/// Does the drone swing about its path, between 0.3 and 3 Hz? RMS of the high-passed position and
/// its zero crossings over a window, for each axis. Equation (D5) of docs/supervisor.md.

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct OscillationConfig {
  double window_s{4.0};
  double high_pass_s{0.6};
  double rms_m{0.12};
  int crossings{3};
  double swing_m{0.05};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("window_s", window_s, Range{0.5, 5.0}, "over which the motion is judged");
    v.field("high_pass_s", high_pass_s, Range{0.05, 10}, "time constant of the high pass, twice");
    v.field("rms_m", rms_m, Range{0.005, 10}, "more than this is an oscillation ...");
    v.field("crossings", crossings, Range{2, 100}, "... if it changes sides so often");
    v.field("swing_m", swing_m, Range{0.001, 10}, "a side counts from this far on");
  }
};

/// kOscillation. Real-time safe: no allocation, no locks, no exceptions.
class OscillationWatch {
 public:
  explicit OscillationWatch(const OscillationConfig& config) noexcept : config_(config) {}

  /// @param p_WD where the newest sensor readings put the drone [m]; absent: not flying or not
  /// known, which forgets what was.
  void update(Time now, const std::optional<Eigen::Vector3d>& p_WD, Findings& out) noexcept;

 private:
  static constexpr Duration kSampling = std::chrono::milliseconds(40);
  static constexpr std::size_t kRoom = 128;

  void judge(Findings& out) const noexcept;
  void push(const Eigen::Vector3d& p) noexcept;
  [[nodiscard]] std::size_t samplesInWindow() const noexcept;

  OscillationConfig config_;
  std::optional<Time> next_;
  Eigen::Vector3d slow_{Eigen::Vector3d::Zero()};    ///< First low pass: of the position, ...
  Eigen::Vector3d slower_{Eigen::Vector3d::Zero()};  ///< ... second: of what the first leaves.
  std::array<Eigen::Vector3d, kRoom> fast_{};        ///< Ring of the high-passed position.
  std::size_t count_{0};
};

}  // namespace tautline
