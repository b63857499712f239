#pragma once

/// @file
/// The simulator's only source of randomness. std::normal_distribution differs between standard
/// libraries, so the transformation is our own: the same seed gives the same flight everywhere.

#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Core>

namespace tautline::sim {

/// Real-time safe: no allocation, no locks, no exceptions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In (-1, 1), 53 bits.
  double signedUniform() noexcept {
    return (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1.0p-52 - 1.0;
  }

  /// Standard normal (Marsaglia's polar method).
  double normal() noexcept {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = signedUniform();
      v = signedUniform();
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double scale = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = v * scale;
    has_spare_ = true;
    return u * scale;
  }

  Eigen::Vector3d normal3() noexcept {
    const double x = normal();
    const double y = normal();
    const double z = normal();
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
  double spare_{0.0};
  bool has_spare_{false};
};

}  // namespace tautline::sim
