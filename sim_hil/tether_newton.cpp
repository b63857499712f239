#include <cmath>

#include <Eigen/LU>

#include "sim_hil/tether_chain.h"

// One backward-Euler step as the minimum of the incremental potential
//   sum m |x - x_free|^2 / 2h^2 + drag + stretch + contacts,
// which is convex: links only pull, surfaces only push.

namespace tautline::sim {
namespace {

constexpr double kForceTolerance = 1e-4;  // residual of one mass's force balance [N]
constexpr int kMaxIterations = 25;
constexpr int kMaxSearch = 8;
constexpr double kFeetStiffness = 4.0;  // of the vehicle on the ground, relative to one contact

Eigen::Matrix3d outer(const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  return a * b.transpose();
}

/// Hessian of a spring of tension T along t.
Eigen::Matrix3d springHessian(double stiffness, double T, double length,
                              const Eigen::Vector3d& t) noexcept {
  const double across = T / length;
  Eigen::Matrix3d K = (stiffness - across) * outer(t, t);
  K.diagonal().array() += across;
  return K;
}

}  // namespace

void TetherChain::minimize(double h, const Obstacles& obstacles, const EndLoad& end) noexcept {
  assemble(h, obstacles, end);
  for (iterations_ = 0; iterations_ < kMaxIterations && residual() > kForceTolerance;
       ++iterations_) {
    solve();
    searchLine(h, obstacles, end);
  }
}

/// Goes along the Newton direction to about the minimum of the potential. The full step is right
/// unless links go slack or taut on the way; then the slope's zero is found by the Illinois method.
/// The potential is convex, so slopes are enough. Leaves everything assembled at the new positions.
void TetherChain::searchLine(double h, const Obstacles& obstacles, const EndLoad& end) noexcept {
  const auto slope = [this] {
    double sum = 0.0;
    for (int i = 1; i <= n_; ++i) sum += gradient_[at(i)].dot(direction_[at(i)]);
    return sum;
  };
  const Nodes start = x_;
  const auto slopeAt = [&](double part) {
    for (int i = 1; i <= n_; ++i) x_[at(i)] = start[at(i)] + part * direction_[at(i)];
    assemble(h, obstacles, end);
    return slope();
  };
  const double first = slope();
  double high = slopeAt(1.0);
  if (high <= -0.5 * first) return;
  double low = first;
  double a = 0.0;
  double b = 1.0;
  for (int i = 0; i < kMaxSearch; ++i) {
    const double part = (a * high - b * low) / (high - low);
    const double now = slopeAt(part);
    if (std::abs(now) <= -0.1 * first) return;
    if (now > 0.0) {
      b = part;
      high = now;
      low *= 0.5;
    } else {
      a = part;
      low = now;
      high *= 0.5;
    }
  }
}

void TetherChain::assemble(double h, const Obstacles& obstacles, const EndLoad& end) noexcept {
  for (int i = 1; i <= n_; ++i) {
    const double inertia = mass_[at(i)] / (h * h);
    const double damping = drag_[at(i)] / h;
    gradient_[at(i)] =
        inertia * (x_[at(i)] - x_free_[at(i)]) + damping * (x_[at(i)] - x_old_[at(i)] - h * wind_);
    diagonal_[at(i)] = (inertia + damping) * Eigen::Matrix3d::Identity();
  }
  assembleLinks(h);
  assembleGround(h, obstacles.floor(), end.ground);
  assembleFaces(h);
}

/// Tension of a link of this length, and its rate with the length; not positive: slack.
double TetherChain::linkForce(double h, int link, double length, double& stiffness) const noexcept {
  const double elastic = config_.axial_stiffness / linkLength(link);
  const double damping = elastic * config_.axial_damping_time / h;
  stiffness = link == disturbance_.cut_link ? 0.0 : elastic + damping;
  if (stiffness == 0.0) return 0.0;
  return stiffness * (length - linkLength(link)) - damping * stretch_[at(link)];
}

void TetherChain::assembleLinks(double h) noexcept {
  for (int j = 0; j < n_; ++j) {
    if (bent_[at(j)]) {
      assembleBentLink(h, j);
      continue;
    }
    const Eigen::Vector3d d = x_[at(j + 1)] - x_[at(j)];
    const double length = d.norm();
    double stiffness = 0.0;
    const double T = linkForce(h, j, length, stiffness);
    tension_[at(j)] = std::fmax(T, 0.0);
    if (T <= 0.0) {
      coupling_[at(j)].setZero();
      continue;
    }
    const Eigen::Vector3d t = d / length;
    const Eigen::Matrix3d K = springHessian(stiffness, T, length, t);
    gradient_[at(j + 1)] += T * t;
    diagonal_[at(j + 1)] += K;
    coupling_[at(j)] = -K;
    if (j == 0) continue;
    gradient_[at(j)] -= T * t;
    diagonal_[at(j)] += K;
  }
}

/// A link bent round edges has one length, through its bends. Capstan law: the tensions at its two
/// ends differ by rub_ times the slip.
void TetherChain::assembleBentLink(double h, int j) noexcept {
  const TetherWrap::Way w = way(j);
  double stiffness = 0.0;
  const double T = std::fmax(0.0, linkForce(h, j, w.length, stiffness));
  const Eigen::Vector3d& a = w.t_first;
  const Eigen::Vector3d& b = w.t_last;
  const double moved =
      0.5 * ((x_[at(j + 1)] - x_old_[at(j + 1)]).dot(b) + (x_[at(j)] - x_old_[at(j)]).dot(a)) +
      0.5 * h * (flow_[at(j)] + flow_[at(j + 1)]);
  const double half_rub = 0.5 * rub_[at(j)] * moved / h;
  const double half_slope = 0.25 * rub_[at(j)] / h;
  if (T <= 0.0) stiffness = 0.0;
  gradient_[at(j + 1)] += (T + half_rub) * b;
  diagonal_[at(j + 1)] += springHessian(stiffness, T, w.last, b) + half_slope * outer(b, b);
  coupling_[at(j)] = (half_slope - stiffness) * outer(a, b);
  if (j > 0) {
    gradient_[at(j)] -= (T - half_rub) * a;
    diagonal_[at(j)] += springHessian(stiffness, T, w.first, a) + half_slope * outer(a, a);
  }
  rubbing_[at(j)] = 2.0 * half_rub;
  tension_[at(j)] = T;
  slip_[at(j)] = moved / h;
}

void TetherChain::assembleGround(double h, double floor, double end_ground) noexcept {
  for (int i = 1; i <= n_; ++i) {
    const double depth = (i < n_ ? floor : end_ground) - x_[at(i)].y();
    ground_force_[at(i)] = 0.0;
    if (depth <= 0.0) continue;
    const double stiffness = (i < n_ ? 1.0 : kFeetStiffness) * config_.contact_stiffness;
    ground_force_[at(i)] = stiffness * depth;
    const double friction = ground_friction_[at(i)] / h;
    const Eigen::Vector3d slip = x_[at(i)] - x_old_[at(i)];
    gradient_[at(i)] +=
        Eigen::Vector3d(friction * slip.x(), -stiffness * depth, friction * slip.z());
    diagonal_[at(i)].diagonal() += Eigen::Vector3d(friction, stiffness, friction);
  }
}

void TetherChain::assembleFaces(double h) noexcept {
  for (FaceContact& c : std::span(face_.data(), at(face_count_))) {
    const double a = 1.0 - c.s;
    const double b = c.s;
    const Eigen::Vector3d p = a * x_[at(c.link)] + b * x_[at(c.link + 1)];
    const double depth = c.offset - c.normal.dot(p);
    c.force = std::fmax(0.0, config_.contact_stiffness * depth);
    if (depth <= 0.0) continue;
    const double friction = c.friction / h;
    const Eigen::Vector3d t = (x_old_[at(c.link + 1)] - x_old_[at(c.link)]).normalized();
    Eigen::Vector3d slip = p - a * x_old_[at(c.link)] - b * x_old_[at(c.link + 1)] + h * c.flow * t;
    slip -= c.normal * c.normal.dot(slip);
    const Eigen::Vector3d g = -c.force * c.normal + friction * slip;
    Eigen::Matrix3d K = (config_.contact_stiffness - friction) * outer(c.normal, c.normal);
    K.diagonal().array() += friction;
    gradient_[at(c.link)] += a * g;
    gradient_[at(c.link + 1)] += b * g;
    diagonal_[at(c.link)] += a * a * K;
    diagonal_[at(c.link + 1)] += b * b * K;
    coupling_[at(c.link)] += a * b * K;
  }
}

double TetherChain::residual() const noexcept {
  double worst = 0.0;
  for (int i = 1; i <= n_; ++i) {
    worst = std::fmax(worst, gradient_[at(i)].cwiseAbs().maxCoeff());
  }
  return worst;
}

/// Block Thomas algorithm: direction_ = -Hessian^-1 gradient_. Node 0 is the fixed outlet.
void TetherChain::solve() noexcept {
  for (int i = 1; i <= n_; ++i) {
    direction_[at(i)] = -gradient_[at(i)];
    if (i > 1) {
      const Eigen::Matrix3d& C = coupling_[at(i - 1)];
      const Eigen::Matrix3d W = C.transpose() * diagonal_[at(i - 1)];  // already inverted
      diagonal_[at(i)] -= W * C;
      direction_[at(i)] -= W * direction_[at(i - 1)];
    }
    diagonal_[at(i)] = diagonal_[at(i)].inverse().eval();
  }
  for (int i = n_; i >= 1; --i) {
    if (i < n_) direction_[at(i)] -= coupling_[at(i)] * direction_[at(i + 1)];
    direction_[at(i)] = diagonal_[at(i)] * direction_[at(i)];
  }
}

}  // namespace tautline::sim
