#include "estimation/tether_filter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "common/catenary.h"
#include "estimation/tension.h"

namespace tautline {
namespace {

constexpr double kMinChord = 0.05;  // [m] nearer to the anchor the angles mean nothing
constexpr double kMinReach = 1e-6;  // [m] keeps azimuth and its derivative defined at the pole
constexpr double kLogTMin = -4.6;   // ln 0.01 N
constexpr double kLogTMax = 4.6;    // ln 100 N
constexpr double kScaleMin = 0.5;
constexpr double kScaleMax = 2.0;
constexpr int kTensionIterations = 3;  // lean and reel tension are strongly curved in ln T
constexpr int kScaleIterations = 6;    // so is a length in a scale that may be off by 40 %

// Position, cross and velocity variance that one axis gains over dt: the integral of a velocity
// that follows its command with lag tau and departs from it with standard deviation sigma, eq.
// (16).
struct MotionNoise {
  double pp, pv, vv;
};
MotionNoise motionNoise(double dt, double tau, double sigma) noexcept {
  const double x = dt / tau;
  const double one_minus_a = -std::expm1(-x);
  const double variance = sigma * sigma;
  // 2x - 3 + 4a - a^2 = 2x - 2(1-a) - (1-a)^2, and its series where that cancels.
  const double pp =
      x < 1e-3 ? 2.0 / 3.0 * x * x * x : 2.0 * (x - one_minus_a) - one_minus_a * one_minus_a;
  return {.pp = variance * tau * tau * pp,
          .pv = variance * tau * one_minus_a * one_minus_a,
          .vv = variance * one_minus_a * (2.0 - one_minus_a)};
}

// d(J_p_q q_dot)/dp: how the velocity that constant rates make changes with the position. Without
// it the filter would take angular rates for absolute speeds, and so believe that it can see the
// length of the tether.
Eigen::Matrix3d velocityGradient(const Eigen::Vector3d& p_AD, const TetherRates& rates) noexcept {
  const double L = std::max(kMinChord, p_AD.norm());
  const double r = std::max(kMinChord, std::hypot(p_AD.x(), p_AD.z()));
  const double phi = toTether(p_AD).phi;
  const Eigen::Vector3d e_r = p_AD / L;
  const Eigen::Vector3d e_out(std::sin(phi), 0.0, std::cos(phi));
  const Eigen::Vector3d e_phi(std::cos(phi), 0.0, -std::sin(phi));
  const Eigen::Vector3d e_up = Eigen::Vector3d::UnitY();
  return rates.L_dot / L * (Eigen::Matrix3d::Identity() - e_r * e_r.transpose()) +
         rates.theta_dot * (e_up * e_out.transpose() - e_out * e_up.transpose() -
                            p_AD.y() / r * e_phi * e_phi.transpose()) +
         rates.phi_dot * (e_phi * e_out.transpose() - e_out * e_phi.transpose());
}

// After an update the covariance still refers to the state before it. Two changes of state leave
// every reading of length and angles as it is: scaling (p_AD, v, s) together, and turning (p_AD, v)
// about the vertical together with the azimuth zero. Their directions depend on the state; this map
// carries the old ones into the new ones, so that no information about them appears from
// linearizing at ever different points, eq. (23).
TetherFilter::Covariance transport(const TetherFilter::State& before,
                                   const TetherFilter::State& after,
                                   const Anchor& anchor) noexcept {
  constexpr double kMinTurnRadius =
      0.3;  // [m] nearer to the pole a turn is no direction to rely on
  constexpr int kP = TetherFilter::kP;
  constexpr int kV = TetherFilter::kV;
  const Eigen::Vector3d p_AD = before.segment<3>(kP) - anchor.p_WA;
  const Eigen::Vector3d turn(p_AD.z(), 0.0, -p_AD.x());  // e_y x p_AD
  const Eigen::RowVector3d along =
      p_AD.transpose() / std::max(kMinChord * kMinChord, p_AD.squaredNorm());
  const Eigen::RowVector3d round =
      turn.transpose() / std::max(kMinTurnRadius * kMinTurnRadius, turn.squaredNorm());
  const Eigen::Vector3d dp = after.segment<3>(kP) - before.segment<3>(kP);
  const Eigen::Vector3d dv = after.segment<3>(kV) - before.segment<3>(kV);
  TetherFilter::Covariance G = TetherFilter::Covariance::Identity();
  G.block<3, 3>(kP, kP) += dp * along + Eigen::Vector3d(dp.z(), 0.0, -dp.x()) * round;
  G.block<3, 3>(kV, kP) += dv * along + Eigen::Vector3d(dv.z(), 0.0, -dv.x()) * round;
  G(TetherFilter::kScale, TetherFilter::kScale) =
      after(TetherFilter::kScale) / before(TetherFilter::kScale);
  return G;
}

Eigen::Vector3d direction(double theta, double phi) noexcept {
  return toCartesian({1.0, theta, phi});
}

}  // namespace

TetherSegment segmentTo(const Eigen::Vector3d& p_AD, double T, double w) noexcept {
  const double distance = p_AD.norm();
  const Eigen::Vector3d p = distance >= kMinChord ? p_AD
                            : distance > 0.0      ? Eigen::Vector3d(p_AD * (kMinChord / distance))
                                                  : Eigen::Vector3d(0.0, kMinChord, 0.0);
  TetherSegment out;
  out.phi = toTether(p).phi;
  out.T = T;
  const double r = std::max(kMinReach, std::hypot(p.x(), p.z()));
  CatenaryInverse inverse = solveInverseCatenary(r, p.y(), out.T, w);
  if (out.T < kTensionMargin * inverse.T_min) {
    out.T = kTensionMargin * inverse.T_min;
    inverse = solveInverseCatenary(r, p.y(), out.T, w);
  }
  out.L = inverse.L;
  out.theta_D = inverse.theta_D;

  CatenaryJacobian J;
  static_cast<void>(solveCatenary({out.L, out.theta_D, out.T, w}, &J));
  const Eigen::Matrix2d J_inverse = J.leftCols<2>().inverse();  // d(L, theta)/d(r, h) at constant T
  const Eigen::Vector2d by_T = -J_inverse * J.col(2);
  const double s_phi = std::sin(out.phi);
  const double c_phi = std::cos(out.phi);
  Eigen::Matrix<double, 2, 3> rh_p;
  rh_p << s_phi, 0.0, c_phi, 0.0, 1.0, 0.0;
  const Eigen::Matrix<double, 2, 3> by_p = J_inverse * rh_p;
  out.L_p = by_p.row(0);
  out.theta_p = by_p.row(1);
  out.phi_p = inverse.H / (out.T * r) * Eigen::RowVector3d(c_phi, 0.0, -s_phi);
  out.L_log_T = out.T * by_T(0);
  out.theta_log_T = out.T * by_T(1);
  return out;
}

TetherFilter::TetherFilter(const LocalizerConfig& config) noexcept : config_(config) {
  reset(Eigen::Vector3d::Zero());
}

double TetherFilter::T() const noexcept { return std::exp(x_(kLogT)); }

void TetherFilter::reset(const Eigen::Vector3d& p0_WD) noexcept {
  const auto square = [](double sigma) { return sigma * sigma; };
  x_.setZero();
  x_(kLogT) = std::log(config_.nominal_tension_n);
  x_(kScale) = 1.0;
  P_.setZero();
  P_(kLogT, kLogT) = square(config_.process.tension_sigma);
  P_(kScale, kScale) = square(config_.prior.reel_scale_sigma);
  P_(kAzimuthZero, kAzimuthZero) = square(config_.prior.azimuth_zero_sigma_rad);
  P_(kElevationBias, kElevationBias) = square(config_.prior.elevation_bias_sigma_rad);
  P_(kAltitudeOffset, kAltitudeOffset) = square(config_.prior.altitude_offset_sigma_m);
  takeoff_height_ = p0_WD.y();
  restart(p0_WD, config_.prior.position_sigma_m, config_.prior.takeoff_velocity_sigma_mps);
}

void TetherFilter::restart(const Eigen::Vector3d& p_WD, double sigma_p, double sigma_v) noexcept {
  x_.segment<3>(kP) = p_WD;
  x_.segment<3>(kV).setZero();
  P_.topRows<6>().setZero();
  P_.leftCols<6>().setZero();
  P_.diagonal().segment<3>(kP).setConstant(sigma_p * sigma_p);
  P_.diagonal().segment<3>(kV).setConstant(sigma_v * sigma_v);
}

void TetherFilter::addPositionUncertainty(double sigma_p) noexcept {
  P_.diagonal().segment<3>(kP).array() += sigma_p * sigma_p;
}

void TetherFilter::predict(double dt, const TetherRates& commanded, const Anchor& anchor) noexcept {
  if (!(dt > 0.0)) return;
  const LocalizerProcessConfig& c = config_.process;
  const double tau = c.velocity_time_constant_s;
  const double a = std::exp(-dt / tau);
  const double reach =
      -tau * std::expm1(-dt / tau);  // what a departure from the command still travels

  TetherRates rates = commanded;
  rates.L_dot *= x_(kScale);  // the reel turns in its own metres
  const Eigen::Vector3d p_AD = p() - anchor.p_WA;
  const TetherCoordinates q = toTether(p_AD);
  const Eigen::Vector3d v_cmd = velocityFromRates(q, rates);
  const Eigen::Matrix3d v_cmd_p = velocityGradient(p_AD, rates);
  const Eigen::Vector3d v_cmd_s = commanded.L_dot * direction(q.theta, q.phi);
  const Eigen::Vector3d departure = v() - v_cmd;
  x_.segment<3>(kP) += v_cmd * dt + reach * departure;  // (16)
  x_.segment<3>(kV) = v_cmd + a * departure;
  const double keep = std::exp(-dt / c.tension_time_constant_s);
  const double nominal = std::log(config_.nominal_tension_n);
  x_(kLogT) = nominal + keep * (x_(kLogT) - nominal);

  Covariance F = Covariance::Identity();
  F.block<3, 3>(kP, kP) += (dt - reach) * v_cmd_p;
  F.block<3, 3>(kP, kV).diagonal().setConstant(reach);
  F.block<3, 1>(kP, kScale) = (dt - reach) * v_cmd_s;
  F.block<3, 3>(kV, kP) = (1.0 - a) * v_cmd_p;
  F.block<3, 3>(kV, kV).diagonal().setConstant(a);
  F.block<3, 1>(kV, kScale) = (1.0 - a) * v_cmd_s;
  F(kLogT, kLogT) = keep;
  P_ = F * P_ * F.transpose();
  const MotionNoise gained = motionNoise(dt, tau, c.velocity_sigma_mps);
  for (int i = 0; i < 3; ++i) {
    P_(kP + i, kP + i) += gained.pp;
    P_(kP + i, kV + i) += gained.pv;
    P_(kV + i, kP + i) += gained.pv;
    P_(kV + i, kV + i) += gained.vv;
  }
  P_(kLogT, kLogT) += c.tension_sigma * c.tension_sigma * (1.0 - keep * keep);
  P_(kScale, kScale) += c.reel_scale_drift * c.reel_scale_drift * dt;
  P_(kAzimuthZero, kAzimuthZero) += c.azimuth_zero_drift_rad * c.azimuth_zero_drift_rad * dt;
  P_(kElevationBias, kElevationBias) +=
      c.elevation_bias_drift_rad * c.elevation_bias_drift_rad * dt;
  P_(kAltitudeOffset, kAltitudeOffset) +=
      c.altitude_offset_drift_m * c.altitude_offset_drift_m * dt;
  clamp(anchor);
}

template <int M, class Model>
Innovation TetherFilter::update(const Model& model, const Eigen::Matrix<double, M, M>& R,
                                double age, const Anchor& anchor, int iterations) noexcept {
  const State x_prior = x_;
  const MotionNoise since = motionNoise(age, config_.process.velocity_time_constant_s,
                                        config_.process.velocity_sigma_mps);
  Innovation out;
  State x = x_prior;
  Eigen::Matrix<double, M, kSize> H;
  Eigen::Matrix<double, M, M> R_total;
  Eigen::Matrix<double, kSize, M> K;
  for (int i = 0; i < iterations; ++i) {
    const Eigen::Vector3d p_then =
        x.template segment<3>(kP) - age * x.template segment<3>(kV);  // (22)
    const Linearized<M> reading = model(x, p_then);
    H = reading.H;
    const Eigen::Matrix<double, M, 3> H_p = H.template middleCols<3>(kP);
    H.template middleCols<3>(kV) = -age * H_p;
    R_total = R + since.pp * H_p * H_p.transpose();
    const Eigen::Matrix<double, M, M> S = H * P_ * H.transpose() + R_total;
    const Eigen::Matrix<double, M, M> S_inverse = S.inverse();
    if (i == 0) {
      out.nis = reading.residual.dot(S_inverse * reading.residual) / M;
      const double gate = config_.health.innovation_gate;
      if (!(out.nis <= gate * gate)) {  // also NaN
        if (!std::isfinite(out.nis)) out.nis = gate * gate;
        return out;
      }
    }
    K = P_ * H.transpose() * S_inverse;
    x = x_prior + K * (reading.residual - H * (x_prior - x));
  }
  const Covariance I_KH = Covariance::Identity() - K * H;
  Covariance P = I_KH * P_ * I_KH.transpose() + K * R_total * K.transpose();
  const Covariance G = transport(x_prior, x, anchor);
  P = G * P * G.transpose();
  P = 0.5 * (P + P.transpose().eval());
  if (!x.allFinite() || !P.allFinite()) return out;
  x_ = x;
  P_ = P;
  out.accepted = true;
  return out;
}

void TetherFilter::clamp(const Anchor& anchor) noexcept {
  const Eigen::Vector3d p_AD = p() - anchor.p_WA;
  const double T_min =
      minimumTension(std::hypot(p_AD.x(), p_AD.z()), p_AD.y(), config_.tether_weight_n_per_m);
  const double log_T_min = T_min > 0.0 ? std::log(kTensionMargin * T_min) : kLogTMin;
  x_(kLogT) = std::clamp(x_(kLogT), std::clamp(log_T_min, kLogTMin, kLogTMax), kLogTMax);
  x_(kScale) = std::clamp(x_(kScale), kScaleMin, kScaleMax);
}

Innovation TetherFilter::updateLength(double L_total, double age, double weight,
                                      const Anchor& anchor) noexcept {
  const double sigma = config_.noise.length_sigma_m;
  return updateLength(L_total, weight * sigma * sigma, age, anchor, 1);
}

Innovation TetherFilter::updateParkedLength(double L_total, const Anchor& anchor) noexcept {
  const double sigma = std::hypot(config_.noise.length_sigma_m, config_.prior.parked_slack_sigma_m);
  const double before = x_(kScale);
  const Innovation out = updateLength(L_total, sigma * sigma, 0.0, anchor, kScaleIterations);
  // Here the place is known, so position and scale have not moved together, as (23) supposes.
  const double undo = before / x_(kScale);
  if (out.accepted) {
    P_.row(kScale) *= undo;
    P_.col(kScale) *= undo;
  }
  return out;
}

Innovation TetherFilter::updateLength(double L_total, double variance, double age,
                                      const Anchor& anchor, int iterations) noexcept {
  const auto model = [&](const State& x, const Eigen::Vector3d& p_then) {  // (17)
    const TetherSegment segment =
        segmentTo(p_then - anchor.p_WA, std::exp(x(kLogT)), config_.tether_weight_n_per_m);
    const double s = x(kScale);
    const double predicted = (segment.L + anchor.L_static) / s;
    Linearized<1> out{.residual = Eigen::Matrix<double, 1, 1>(L_total - predicted),
                      .H = Eigen::Matrix<double, 1, kSize>::Zero()};
    out.H.middleCols<3>(kP) = segment.L_p / s;
    out.H(kLogT) = segment.L_log_T / s;
    out.H(kScale) = -predicted / s;
    return out;
  };
  const Innovation out =
      update<1>(model, Eigen::Matrix<double, 1, 1>(variance), age, anchor, iterations);
  clamp(anchor);
  return out;
}

Innovation TetherFilter::updateAngles(double theta, double phi, double age, double weight,
                                      const Anchor& anchor) noexcept {
  // The innovation is a rotation between two directions, in the axes of increasing theta and phi:
  // regular at the pole, where phi is not, and beyond it.
  const auto model = [&](const State& x, const Eigen::Vector3d& p_then) {  // (18)
    const TetherSegment segment =
        segmentTo(p_then - anchor.p_WA, std::exp(x(kLogT)), config_.tether_weight_n_per_m);
    const Eigen::Vector3d sensed = direction(theta - x(kElevationBias), phi - x(kAzimuthZero));
    const Eigen::Matrix3d axes = jacobian({1.0, segment.theta_D, segment.phi});
    const Eigen::Vector3d e_phi(std::cos(segment.phi), 0.0, -std::sin(segment.phi));
    const Eigen::Vector2d across(axes.col(1).dot(sensed), e_phi.dot(sensed));
    const double n = across.norm();
    const double angle = std::atan2(n, axes.col(0).dot(sensed));
    Linearized<2> out{.residual = n > 0.0 ? Eigen::Vector2d(across * (angle / n)) : across,
                      .H = Eigen::Matrix<double, 2, kSize>::Zero()};
    out.H.block<1, 3>(0, kP) = segment.theta_p;
    out.H(0, kLogT) = segment.theta_log_T;
    out.H(0, kElevationBias) = 1.0;
    out.H.block<1, 3>(1, kP) = segment.phi_p;
    out.H(1, kAzimuthZero) = std::cos(segment.theta_D);
    return out;
  };
  const double sigma_theta = config_.noise.elevation_sigma_rad;
  const double across =
      std::hypot(std::cos(theta) * config_.noise.azimuth_sigma_rad, std::sin(theta) * sigma_theta);
  const Eigen::Vector2d variance =
      weight * Eigen::Vector2d(sigma_theta * sigma_theta, across * across);
  const Innovation out = update<2>(model, Eigen::Matrix2d(variance.asDiagonal()), age, anchor, 1);
  clamp(anchor);
  return out;
}

Innovation TetherFilter::updateAltitude(double altitude, double age, double weight,
                                        const Anchor& anchor) noexcept {
  const auto model = [&](const State& x, const Eigen::Vector3d& p_then) {  // (19)
    const double predicted = p_then.y() - takeoff_height_ + x(kAltitudeOffset);
    Linearized<1> out{.residual = Eigen::Matrix<double, 1, 1>(altitude - predicted),
                      .H = Eigen::Matrix<double, 1, kSize>::Zero()};
    out.H(kP + 1) = 1.0;
    out.H(kAltitudeOffset) = 1.0;
    return out;
  };
  const double sigma = config_.noise.altitude_sigma_m;
  return update<1>(model, Eigen::Matrix<double, 1, 1>(weight * sigma * sigma), age, anchor, 1);
}

Innovation TetherFilter::updateLean(const Eigen::Quaterniond& R_WB, double age, double weight,
                                    const Anchor& anchor) noexcept {
  const auto model = [&](const State& x, const Eigen::Vector3d& p_then) {  // (20)
    const double T = std::exp(x(kLogT));
    const TetherSegment segment = segmentTo(p_then - anchor.p_WA, T, config_.tether_weight_n_per_m);
    const LeanModel lean = leanModel(T, segment.theta_D, config_.vehicle_weight_n);
    const double beta = thrustElevationInPlane(R_WB, segment.phi);
    Linearized<1> out{.residual = Eigen::Matrix<double, 1, 1>(wrapAngle(beta - lean.beta)),
                      .H = Eigen::Matrix<double, 1, kSize>::Zero()};
    out.H.middleCols<3>(kP) = lean.dbeta_dtheta * segment.theta_p;
    out.H(kLogT) = lean.dbeta_dT * T + lean.dbeta_dtheta * segment.theta_log_T;
    return out;
  };
  const double sigma = config_.noise.lean_sigma_rad;
  const Innovation out = update<1>(model, Eigen::Matrix<double, 1, 1>(weight * sigma * sigma), age,
                                   anchor, kTensionIterations);
  clamp(anchor);
  return out;
}

Innovation TetherFilter::updateReelTension(double T_reel, double age, double weight,
                                           const Anchor& anchor) noexcept {
  const double w = config_.tether_weight_n_per_m;
  const auto model = [&](const State& x, const Eigen::Vector3d& p_then) {  // (21)
    const double T = std::exp(x(kLogT));
    Linearized<1> out{
        .residual = Eigen::Matrix<double, 1, 1>(T_reel - (T - w * (p_then.y() - anchor.p_WA.y()))),
        .H = Eigen::Matrix<double, 1, kSize>::Zero()};
    out.H(kP + 1) = -w;
    out.H(kLogT) = T;
    return out;
  };
  const double sigma = T_reel * std::hypot(config_.noise.reel_tension_sigma,
                                           anchor.contact_count * config_.noise.capstan_log_sigma);
  const double variance =
      weight * std::max(sigma * sigma, 1e-6);  // [N^2], a slack reel still says something
  const Innovation out =
      update<1>(model, Eigen::Matrix<double, 1, 1>(variance), age, anchor, kTensionIterations);
  clamp(anchor);
  return out;
}

}  // namespace tautline
