#include "estimation/contact_observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/tether_geometry.h"
#include "estimation/evidence.h"

namespace tautline {
namespace {

constexpr double kGravity = 9.81;
constexpr double kLeastUpright = 0.5;  // n_y; leaning more than this the drone is not hovering
constexpr double kLongestStep = 0.5;   // [s] after a longer gap everything begins anew
constexpr double kCap = 2.0;           // evidence is kept up to this many thresholds
constexpr int kHypotheses = 5;

bool isFinite(const ContactObserverInput& in) noexcept {
  return std::isfinite(in.L_total) && std::isfinite(in.theta) && std::isfinite(in.phi) &&
         std::isfinite(in.T) && in.R_WB.coeffs().allFinite() && in.anchor.p_WA.allFinite() &&
         std::isfinite(in.anchor.L_static);
}

/// What accelerates the drone besides drag [m/s^2]: thrust that carries weight and pull, less both.
/// Right across the tether's plane; in it the pull is not known well enough.
Eigen::Vector3d acceleration(const ContactObserverInput& in, const Eigen::Vector3d& d) noexcept {
  const Eigen::Vector3d n = in.R_WB * Eigen::Vector3d::UnitY();
  const double carried = in.G + in.T * d.y();
  const Eigen::Vector3d force =
      carried / std::max(kLeastUpright, n.y()) * n - in.T * d - in.G * Eigen::Vector3d::UnitY();
  return force * (kGravity / in.G);
}

}  // namespace

void BandFilter::reset(const Eigen::Vector3d& x, double a) noexcept {
  s1_ = s2_ = x;
  s3_ = x / a;
}

void BandFilter::update(double dt, double lambda, double a, const Eigen::Vector3d& x) noexcept {
  const double gain = -std::expm1(-lambda * dt);
  s1_ += gain * (x - s1_);
  s2_ += gain * (s1_ - s2_);
  s3_ = s2_ / a + std::exp(-a * dt) * (s3_ - s2_ / a);
}

void BandFilter::shift(const Eigen::Vector3d& by, double a) noexcept {
  s1_ += by;
  s2_ += by;
  s3_ += by / a;
}

ContactObserver::ContactObserver(const ContactObserverConfig& config) noexcept
    : config_(config),
      lambda_(2.0 * std::numbers::pi * config.smoothing_rate_hz),
      a_(2.0 * std::numbers::pi * config.forget_rate_hz),
      threshold_(
          evidenceThreshold(kHypotheses, config.correlation_time_s, config.false_alarms_per_hour)),
      slip_(config.slip) {}

const ContactVerdict& ContactObserver::update(Time now, const ContactObserverInput& in) noexcept {
  const double dt = last_ && now > *last_ ? toSeconds(now - *last_) : 0.0;
  if (!in.flying) {
    began_.reset();
    last_.reset();
    verdict_ = {};
    return verdict_;
  }
  if (!isFinite(in)) return verdict_;
  if (last_ && dt <= 0.0) return verdict_;
  const Eigen::Vector3d d = toCartesian({1.0, in.theta, in.phi});
  const double L = std::max(0.0, in.L_total - in.anchor.L_static);
  if (!began_) {
    began_ = now;
    formed_ = false;
  }
  const bool anew = !last_ || dt > kLongestStep;
  last_ = now;
  if (anew) {
    offset_.setZero();
    anchor_ = in.anchor;
    anchors_.fill(std::nullopt);
    p_.reset(in.anchor.p_WA + L * d, a_);
    d_.reset(d, a_);
    f_.reset(acceleration(in, d), a_);
    bias_ = 0.0;
    before_ = holds_ = 0.0;
    unplanned_.fill(0.0);
    slip_.restart();
    changed_.reset();
    began_ = now;
    return verdict_;
  }
  if (in.anchor.contact_count != anchor_.contact_count || in.anchor.p_WA != anchor_.p_WA)
    changeAnchor(now, in, d);
  p_.update(dt, lambda_, a_, in.anchor.p_WA + L * d + offset_);
  d_.update(dt, lambda_, a_, d);
  f_.update(dt, lambda_, a_, acceleration(in, d));

  const Eigen::Vector3d across(std::cos(in.phi), 0.0, -std::sin(in.phi));
  const Eigen::Vector3d difference =
      f_.value() - p_.acceleration(lambda_, a_) - config_.drag_per_s * p_.rate(a_);
  const Eigen::Vector3d turning = d_.acceleration(lambda_, a_) + config_.drag_per_s * d_.rate(a_);
  const double raw = across.dot(difference);
  bias_ += -std::expm1(-dt / config_.bias_time_s) * (raw - bias_);
  residual_ = raw - bias_;
  turning_ = across.dot(turning);
  judge(now, dt, L);
  watchSlip(now, in, L);
  decide(in, d, L);
  return verdict_;
}

/// The signal goes on where it was: the executor believes something else, nothing has moved.
void ContactObserver::changeAnchor(Time now, const ContactObserverInput& in,
                                   const Eigen::Vector3d& d) noexcept {
  const double L_old = in.L_total - anchor_.L_static;
  const double L_new = in.L_total - in.anchor.L_static;
  offset_ += anchor_.p_WA + L_old * d - (in.anchor.p_WA + L_new * d);
  popped_ = in.anchor.contact_count <= anchor_.contact_count;
  const auto below = static_cast<std::size_t>(std::clamp(anchor_.contact_count, 0, kDeepest));
  anchors_[below] = anchor_.p_WA;
  anchor_ = in.anchor;
  changed_ = now;
  formed_ = popped_;
  before_ = holds_ = 0.0;
  unplanned_.fill(0.0);
  slip_.restart();
}

/// Of the active contact; null for the reel, and where the observer was not there when the contact
/// was made.
const Eigen::Vector3d* ContactObserver::anchorBelow() const noexcept {
  if (anchor_.contact_count < 1 || anchor_.contact_count > kDeepest + 1) return nullptr;
  const auto& below = anchors_[static_cast<std::size_t>(anchor_.contact_count - 1)];
  return below ? &*below : nullptr;
}

/// Log likelihood ratio of a lever that is `extra` longer against the active one.
double ContactObserver::evidenceOf(double extra, double L) const noexcept {
  const double expected = extra * turning_;
  const double uncertain = config_.lever_sigma * (L + std::abs(extra)) * turning_;
  const double variance = config_.sigma_mps * config_.sigma_mps + uncertain * uncertain;
  return (expected * residual_ - 0.5 * expected * expected) / variance;
}

void ContactObserver::judge(Time now, double dt, double L) noexcept {
  const double cap = kCap * threshold_;
  const double keep = std::exp(-dt / config_.memory_s);
  const auto add = [&](double& sum, double evidence) {
    sum = std::clamp(keep * sum + evidence * dt / config_.correlation_time_s, 0.0, cap);
  };
  const double since = changed_ ? toSeconds(now - *changed_) : 1e9;
  const bool settled = toSeconds(now - *began_) > config_.settle_s;
  const bool relaxing = popped_ && since < config_.relax_s;
  if (!settled || relaxing) {
    before_ = 0.0;
    unplanned_.fill(0.0);
    return;
  }
  if (const Eigen::Vector3d* const below = anchorBelow()) {
    const double extra = (anchor_.p_WA - *below).norm();
    if (extra >= config_.least_lever_m) {
      const double evidence = evidenceOf(extra, L);
      add(before_, evidence);
      add(holds_, -evidence);
      formed_ = formed_ || (since > config_.form_s && holds_ >= threshold_ && before_ < 1.0);
    }
  }
  for (std::size_t i = 0; i < kUnplannedShares.size(); ++i) {
    const double extra = -(1.0 - kUnplannedShares[i]) * L;
    if (-extra >= config_.least_lever_m) {
      add(unplanned_[i], evidenceOf(extra, L));
    } else {
      unplanned_[i] *= keep;
    }
  }
}

/// Only about a contact that has had its time to form, or the one let go before it to come off.
void ContactObserver::watchSlip(Time now, const ContactObserverInput& in, double L) noexcept {
  const double since = toSeconds(now - changed_.value_or(*began_));
  const bool at_contact =
      anchor_.contact_count > 0 && since >= (popped_ ? config_.relax_s : config_.form_s);
  if (!at_contact || !in.height || !std::isfinite(*in.height) || !std::isfinite(in.sag)) {
    slip_.restart();
    return;
  }
  const double reckoned = anchor_.p_WA.y() + L * std::sin(in.theta - in.sag);
  slip_.update(now, in.height_sequence, *in.height - reckoned);
}

void ContactObserver::decide(const ContactObserverInput& in, const Eigen::Vector3d& d,
                             double L) noexcept {
  const auto most = std::max_element(unplanned_.begin(), unplanned_.end());
  const bool forming = changed_ && !formed_ && toSeconds(*last_ - *changed_) < config_.form_s;
  const double before = forming ? 0.0 : before_;
  const bool earlier = before >= *most;
  const double evidence = std::max(before, *most) / threshold_;
  verdict_ = {};
  verdict_.evidence = evidence;
  verdict_.lever = L;
  verdict_.p_WC = in.anchor.p_WA;
  verdict_.slip = slip_.slip();
  if (evidence < 1.0) {
    if (slip_.slipped()) verdict_.hypothesis = TetherHypothesis::kSlipped;
    return;
  }
  if (earlier) {
    verdict_.hypothesis = formed_ ? TetherHypothesis::kLost : TetherHypothesis::kNotFormed;
    if (const Eigen::Vector3d* const below = anchorBelow()) verdict_.p_WC = *below;
    verdict_.lever = L + (anchor_.p_WA - verdict_.p_WC).norm();
  } else {
    const auto share = kUnplannedShares[static_cast<std::size_t>(most - unplanned_.begin())];
    // A tether that has come off is slack for a moment: its end swings and the drone does not.
    const bool off = formed_ && in.anchor.contact_count > 0;
    verdict_.hypothesis = off ? TetherHypothesis::kLost : TetherHypothesis::kUnplanned;
    verdict_.lever = share * L;
    verdict_.p_WC = in.anchor.p_WA + (1.0 - share) * L * d;
  }
}

}  // namespace tautline
