#include "sim_hil/truth.h"

#include <tautline/sim_truth_t.hpp>

namespace tautline::sim {

void fillTruth(const Truth& truth, std::int64_t utime, tautline::sim_truth_t& message) noexcept {
  message.utime = utime;
  for (int i = 0; i < 3; ++i) {
    message.position_m[i] = truth.p_WD[i];
    message.velocity_mps[i] = truth.v_WD[i];
    message.anchor_m[i] = truth.p_WA[i];
    message.gust_mps[i] = truth.gust[i];
  }
  message.tension_n = truth.tension;
  message.reel_tension_n = truth.reel_tension;
  message.length_m = truth.length;
  message.reel_scale = truth.reel_scale;
  message.tangent_elevation_rad = truth.tangent_elevation;
  message.tangent_azimuth_rad = truth.tangent_azimuth;
  message.on_ground = truth.on_ground ? 1 : 0;
  message.motors_on = truth.motors_on ? 1 : 0;
  message.crashed = truth.crashed ? 1 : 0;
  message.crash_reason = static_cast<std::int8_t>(truth.crash_reason);
  message.contact_count = static_cast<std::int16_t>(truth.contact_count);
}

}  // namespace tautline::sim
