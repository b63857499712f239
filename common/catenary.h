#pragma once

/// @file
/// Static sag of the free tether segment between the active anchor A (reel outlet or last contact)
/// and the drone D. Equations (5)-(10) of docs/tether_model.md.
///
/// Model: inextensible, perfectly flexible, weight per length w, no drag; exact, closed form, no
/// cancellation. All quantities live in the vertical plane through A and D:
///
///        y (up)          s : arc length from A,           0 <= s <= L
///        |      _.-D     H : horizontal tension, constant along s
///        |   _-'         V : vertical tension,   V(s) = V_A + w s
///        A-'------ r     T : |(H, V)|
///
/// The tangent elevation and the tension are taken at D, where the drone's sensors are. SI units,
/// radians. Everything here is real-time safe: no allocation, no locks, no exceptions, bounded
/// time.

#include <cstdint>

#include <Eigen/Core>

namespace tautline {

/// What is known of a segment.
struct CatenaryInput {
  double L{};        ///< Free arc length A to D [m], >= 0.
  double theta_D{};  ///< Tangent elevation at D [rad], in [-pi/2, pi/2]; positive: the tether
                     ///< leaves D downwards.
  double T_D{};      ///< Tension at D [N], > 0.
  double w{};        ///< Weight per length [N/m], >= 0; 0 = straight line.
};

/// Where D is, and the forces at both ends. Valid only if `ok`.
struct CatenarySolution {
  bool ok{false};  ///< False: input outside its domain or not finite.
  bool dips_below_anchor{
      false};      ///< V_A < 0: the lowest point hangs below A; real only above the floor.
  double r{};      ///< Horizontal reach A to D [m], >= 0, eq. (7).
  double h{};      ///< Height of D above A [m], eq. (6).
  double chord{};  ///< Straight distance A to D [m], <= L.
  double chord_elevation{};  ///< Elevation of the straight line A to D [rad]; <= theta_D. theta_D
                             ///< if chord = 0.
  double theta_A{};          ///< Tangent elevation at A [rad].
  double H{};                ///< Horizontal tension [N].
  double V_A{};              ///< Vertical tension at A [N], up positive on the tether's drone side.
  double V_D{};              ///< Vertical tension at D [N].
  double T_A{};              ///< Tension at A [N].
};

/// d(r, h) / d(L, theta_D, T_D): rows r, h.
using CatenaryJacobian = Eigen::Matrix<double, 2, 3>;

/// Eqs. (5)-(7): position from arc length, tangent and tension at D. `jacobian` (optional) gets eq.
/// (8); it is finite everywhere in the domain, also at H = 0.
[[nodiscard]] CatenarySolution solveCatenary(const CatenaryInput& in,
                                             CatenaryJacobian* jacobian = nullptr) noexcept;

/// The end of the segment at which a tension is prescribed.
enum class TensionEnd : std::uint8_t { kDrone, kAnchor };

enum class CatenaryStatus : std::uint8_t {
  kOk,
  kNotReachable,  ///< T < T_min: no static shape reaches this point at this tension; pay no
                  ///< attention to the rest.
  kInvalid,       ///< Input outside its domain or not finite.
};

/// The taut (shorter) segment that reaches a point. Valid only if kOk, but T_min also if
/// kNotReachable.
struct CatenaryInverse {
  CatenaryStatus status{CatenaryStatus::kInvalid};
  bool dips_below_anchor{false};  ///< V_A < 0.
  double L{};                     ///< Arc length to pay out [m], >= chord.
  double theta_D{};               ///< Tangent elevation at D [rad]: what the drone's sensor reads.
  double theta_A{};               ///< Tangent elevation at A [rad].
  double T_D{};                   ///< [N]
  double T_A{};                   ///< [N]; T_D - T_A = w h.
  double H{};                     ///< [N]
  double T_min{};  ///< Least tension, at the prescribed end, with which the point can be held [N].

  [[nodiscard]] explicit operator bool() const noexcept { return status == CatenaryStatus::kOk; }
};

/// Eq. (9): the segment from A to the point (r, h) with tension T at `end`.
/// Domain: r >= 0, T > 0, w >= 0, all finite. r = 0 is the straight vertical tether, r = h = 0 has
/// L = 0 and theta_D = 0. Newton from the left of the taut root, monotone, at most 80 steps
/// (typically 4).
[[nodiscard]] CatenaryInverse solveInverseCatenary(double r, double h, double T, double w,
                                                   TensionEnd end = TensionEnd::kDrone) noexcept;

/// Least tension at `end` [N] with which (r, h) can be held, eq. (10); 0 outside the domain of
/// solveInverseCatenary().
[[nodiscard]] double minimumTension(double r, double h, double w,
                                    TensionEnd end = TensionEnd::kDrone) noexcept;

struct ReelTension {
  bool ok{false};  ///< False: the anchor tension cannot carry this segment, or input outside its
                   ///< domain.
  double T_D{};    ///< Tension at D [N], > 0.
};

/// Eq. (11): tension at D from the tension T_A at the anchor [N], arc length L [m] and tangent
/// elevation at D [rad]:
///   T_D = w L sin(theta_D) + sqrt(T_A^2 - (w L cos(theta_D))^2).
/// With contacts T_A is the reel's tension times the capstan factor exp(+-mu * sum of turn angles):
/// `capstan_factor`.
[[nodiscard]] ReelTension tensionFromReel(double T_reel, double L, double theta_D, double w,
                                          double capstan_factor = 1.0) noexcept;

}  // namespace tautline
