#include "sim_hil/tether_chain.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace tautline::sim {
namespace {

constexpr double kGravity = 9.81;            // [m/s^2]
constexpr double kAirDensity = 1.2;          // [kg/m^3]
constexpr double kForceTolerance = 1e-4;     // residual of one mass's force balance [N]
constexpr int kMaxIterations = 12;
constexpr double kContactMargin = 0.01;      // [m]
constexpr double kCreep = 0.002;             // slip speed below which friction is viscous [m/s]

Eigen::Matrix3d outer(const Eigen::Vector3d& a) noexcept { return a * a.transpose(); }

/// Part of a motion that rubs: along the surface, with the material that flows along the tether's
/// direction t. At a node on an edge the material slides by the capstan law (tether_mesh.h), so only
/// the motion along the edge is left.
Eigen::Vector3d slipOf(const TetherContact& c, const Eigen::Vector3d& motion, double flow,
                       const Eigen::Vector3d& t) noexcept {
  const Eigen::Vector3d slip = motion - c.normal * c.normal.dot(motion);
  return c.at_node ? Eigen::Vector3d(slip - t * t.dot(slip)) : Eigen::Vector3d(slip + flow * t);
}

}  // namespace

TetherChain::TetherChain(const TetherConfig& config, const Eigen::Vector3d& p_WD, double L)
    : config_(config), n_(config.links), L_(L), mesh_(config.links) {
  for (int i = 0; i <= n_; ++i) {
    x_[at(i)] = p_WD * (static_cast<double>(i) / n_);
    v_[at(i)].setZero();
  }
  x_old_ = x_;
}

void TetherChain::step(double h, double L, const EndLoad& end, const Eigen::Vector3d& wind,
                       const Obstacles& obstacles) noexcept {
  moveMesh(h, L);
  const double L_rate = (L - L_) / h;
  L_ = L;
  x_old_ = x_;
  prepare(h, end, wind);
  for (int i = 1; i <= n_; ++i) x_[at(i)] += h * v_[at(i)];
  findContacts(obstacles, L_rate);

  Nodes best = x_;
  double best_potential = 0.0;
  double scale = 1.0;
  for (iterations_ = 0; iterations_ < kMaxIterations; ++iterations_) {
    const double potential = assemble(h, obstacles, end);
    const bool worse = iterations_ > 0 && potential > best_potential + 1e-12;
    if (worse && scale > 0.1) {  // Newton overshot a link going slack or taut
      scale *= 0.5;
      for (int i = 1; i <= n_; ++i) x_[at(i)] = best[at(i)] + scale * direction_[at(i)];
      continue;
    }
    if (residual() < kForceTolerance) break;
    best = x_;
    best_potential = potential;
    scale = 1.0;
    solve();
    for (int i = 1; i <= n_; ++i) x_[at(i)] += direction_[at(i)];
  }
  for (int i = 1; i <= n_; ++i) v_[at(i)] = (x_[at(i)] - x_old_[at(i)]) / h;
  for (int j = 0; j < n_; ++j) {
    stretch_[at(j)] = std::fmax(0.0, (x_[at(j + 1)] - x_[at(j)]).norm() - linkLength(j));
  }
  const auto loaded_end =
      std::remove_if(contact_.begin(), contact_.begin() + contact_count_,
                     [](const TetherContact& c) { return c.force <= 0.0; });
  contact_count_ = static_cast<int>(loaded_end - contact_.begin());
}

void TetherChain::moveMesh(double h, double L) noexcept {
  NodeScalars turn{};
  for (const TetherContact& c : contacts()) {
    const int k = mesh_.nodeAt(c, L_);
    if (k < 0) continue;
    const Eigen::Vector3d a = x_[at(k)] - x_[at(k - 1)];
    const Eigen::Vector3d b = x_[at(k + 1)] - x_[at(k)];
    turn[at(k)] = std::atan2(a.cross(b).norm(), a.dot(b));
  }
  mesh_.update(h, {L_, L, config_.axial_stiffness, config_.friction, contacts(), &tension_, &turn});
}

void TetherChain::prepare(double h, const EndLoad& end, const Eigen::Vector3d& wind) noexcept {
  wind_ = wind;
  const double drag_per_length =
      0.5 * kAirDensity * config_.drag_coefficient * config_.diameter;
  for (int i = 1; i <= n_; ++i) {
    const double length = 0.5 * (linkLength(i - 1) + (i < n_ ? linkLength(i) : 0.0));
    mass_[at(i)] = config_.density * length;
    Eigen::Vector3d force(0.0, -kGravity * mass_[at(i)], 0.0);
    drag_[at(i)] =
        length * (drag_per_length * (v_[at(i)] - wind).norm() + config_.internal_damping);
    if (i == n_) {
      mass_[at(i)] += end.mass;
      force += end.force;
      drag_[at(i)] += end.drag;
    }
    x_free_[at(i)] = x_old_[at(i)] + h * v_[at(i)] + (h * h / mass_[at(i)]) * force;
    const double slip = std::hypot(v_[at(i)].x(), v_[at(i)].z());
    ground_friction_[at(i)] =
        config_.floor_friction * ground_force_[at(i)] / std::fmax(slip, kCreep);
  }
}

void TetherChain::findContacts(const Obstacles& obstacles, double L_rate) noexcept {
  const std::array<TetherContact, kMaxChainContacts> last = contact_;
  const int last_count = contact_count_;
  contact_count_ = 0;
  if (obstacles.solids().empty()) return;
  Aabb whole;
  for (int i = 0; i <= n_; ++i) whole.include(x_[at(i)]);

  std::array<std::size_t, kMaxSolids> near{};
  std::size_t near_count = 0;
  for (std::size_t k = 0; k < obstacles.solids().size(); ++k) {
    if (obstacles.bounds(k).overlaps(whole, kContactMargin)) near[near_count++] = k;
  }
  for (int j = 0; j < n_ && near_count > 0; ++j) {
    Aabb link;
    link.include(x_[at(j)]);
    link.include(x_[at(j + 1)]);
    for (std::size_t k = 0; k < near_count; ++k) {
      if (!obstacles.bounds(near[k]).overlaps(link, kContactMargin)) continue;
      std::array<SegmentContact, kMaxSegmentContacts> found;
      const int count = segmentContacts(obstacles.solids()[near[k]], x_[at(j)], x_[at(j + 1)],
                                        kContactMargin, found);
      for (int c = 0; c < count && contact_count_ < kMaxChainContacts; ++c) {
        const SegmentContact& f = found[at(c)];
        TetherContact& contact = contact_[at(contact_count_++)];
        contact.link = j;
        contact.s = f.s;
        contact.solid = static_cast<int>(near[k]);
        contact.feature = f.feature;
        contact.normal = f.normal;
        contact.offset = f.offset;
        setFriction(contact, {last.data(), at(last_count)}, L_rate);
      }
    }
  }
}

/// Coulomb friction with the normal force of the last step; viscous while it creeps.
void TetherChain::setFriction(TetherContact& c, std::span<const TetherContact> last,
                              double L_rate) const noexcept {
  c.at_node = mesh_.nodeAt(c, L_) >= 0;
  double force = 0.0;
  for (const TetherContact& old : last) {
    const bool same = old.solid == c.solid && std::abs(old.link - c.link) <= 1 &&
                      (old.feature == c.feature || old.link == c.link);
    if (same) force = std::fmax(force, old.force);
  }
  const double sigma = mesh_.position(c.link) + c.s * mesh_.fraction(c.link);
  const double sigma_rate = (1.0 - c.s) * mesh_.rate(c.link) + c.s * mesh_.rate(c.link + 1);
  c.flow = (1.0 - sigma) * L_rate - L_ * sigma_rate;
  const Eigen::Vector3d t = (x_[at(c.link + 1)] - x_[at(c.link)]).normalized();
  const Eigen::Vector3d v = (1.0 - c.s) * v_[at(c.link)] + c.s * v_[at(c.link + 1)];
  c.friction = config_.friction * force / std::fmax(slipOf(c, v, c.flow, t).norm(), kCreep);
}

double TetherChain::assemble(double h, const Obstacles& obstacles, const EndLoad& end) noexcept {
  double potential = 0.0;
  for (int i = 1; i <= n_; ++i) {
    const double inertia = mass_[at(i)] / (h * h);
    const double damping = drag_[at(i)] / h;
    const Eigen::Vector3d off = x_[at(i)] - x_free_[at(i)];
    const Eigen::Vector3d slip = x_[at(i)] - x_old_[at(i)] - h * wind_;
    gradient_[at(i)] = inertia * off + damping * slip;
    diagonal_[at(i)] = (inertia + damping) * Eigen::Matrix3d::Identity();
    potential += 0.5 * (inertia * off.squaredNorm() + damping * slip.squaredNorm());
  }
  potential += assembleLinks(h);
  potential += assembleGround(h, obstacles.floor(), end.ground);
  return potential + assembleContacts(h);
}

double TetherChain::assembleLinks(double h) noexcept {
  double potential = 0.0;
  for (int j = 0; j < n_; ++j) {
    const Eigen::Vector3d d = x_[at(j + 1)] - x_[at(j)];
    const double length = d.norm();
    const double stiffness = config_.axial_stiffness / linkLength(j);
    const double damping = stiffness * config_.axial_damping_time / h;
    const double total = stiffness + damping;
    const double T =
        total * (length - linkLength(j)) - damping * stretch_[at(j)];  // < 0: slack, carries nothing
    if (T <= 0.0) {
      tension_[at(j)] = 0.0;
      coupling_[at(j)].setZero();
      continue;
    }
    tension_[at(j)] = T;
    potential += 0.5 * T * T / total;
    const Eigen::Vector3d t = d / length;
    const double across = T / length;
    Eigen::Matrix3d K = (total - across) * outer(t);
    K.diagonal().array() += across;
    gradient_[at(j + 1)] += T * t;
    diagonal_[at(j + 1)] += K;
    coupling_[at(j)] = -K;
    if (j == 0) continue;
    gradient_[at(j)] -= T * t;
    diagonal_[at(j)] += K;
  }
  return potential;
}

double TetherChain::assembleGround(double h, double floor, double end_ground) noexcept {
  double potential = 0.0;
  for (int i = 1; i <= n_; ++i) {
    const double ground = i < n_ ? floor : end_ground;
    const double depth = ground - x_[at(i)].y();
    // The vehicle's feet are the surface's stiffness times its share of the mass.
    const double stiffness = (i < n_ ? 1.0 : 4.0) * config_.contact_stiffness;
    ground_force_[at(i)] = 0.0;
    if (depth <= 0.0) continue;
    ground_force_[at(i)] = stiffness * depth;
    const double friction = ground_friction_[at(i)] / h;
    const Eigen::Vector3d slip = x_[at(i)] - x_old_[at(i)];
    gradient_[at(i)] += Eigen::Vector3d(friction * slip.x(), -stiffness * depth, friction * slip.z());
    diagonal_[at(i)].diagonal() += Eigen::Vector3d(friction, stiffness, friction);
    potential += 0.5 * stiffness * depth * depth +
                 0.5 * friction * (slip.x() * slip.x() + slip.z() * slip.z());
  }
  return potential;
}

double TetherChain::assembleContacts(double h) noexcept {
  double potential = 0.0;
  for (int k = 0; k < contact_count_; ++k) {
    TetherContact& c = contact_[at(k)];
    const double a = 1.0 - c.s;
    const double b = c.s;
    const Eigen::Vector3d p = a * x_[at(c.link)] + b * x_[at(c.link + 1)];
    const double depth = c.offset - c.normal.dot(p);
    c.force = std::fmax(0.0, config_.contact_stiffness * depth);
    if (depth <= 0.0) continue;
    const double friction = c.friction / h;
    const Eigen::Vector3d t = (x_old_[at(c.link + 1)] - x_old_[at(c.link)]).normalized();
    const Eigen::Vector3d moved = p - a * x_old_[at(c.link)] - b * x_old_[at(c.link + 1)];
    const Eigen::Vector3d slip = slipOf(c, moved, h * c.flow, t);
    const Eigen::Vector3d g = -c.force * c.normal + friction * slip;
    Eigen::Matrix3d K = (config_.contact_stiffness - friction) * outer(c.normal);
    K.diagonal().array() += friction;
    if (c.at_node) K -= friction * outer(t);
    gradient_[at(c.link)] += a * g;
    gradient_[at(c.link + 1)] += b * g;
    diagonal_[at(c.link)] += a * a * K;
    diagonal_[at(c.link + 1)] += b * b * K;
    coupling_[at(c.link)] += a * b * K;
    potential += 0.5 * c.force * depth + 0.5 * friction * slip.squaredNorm();
  }
  return potential;
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
      const Eigen::Matrix3d W = C * diagonal_[at(i - 1)];  // already inverted
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

Eigen::Vector3d TetherChain::endTension() const noexcept {
  const int j = n_ - 1;
  const Eigen::Vector3d t = (x_[at(n_)] - x_[at(j)]).normalized();
  const double half_weight = 0.5 * kGravity * config_.density * linkLength(j);
  return tension_[at(j)] * t + half_weight * Eigen::Vector3d::UnitY();
}

double TetherChain::reelTension() const noexcept {
  const Eigen::Vector3d t = (x_[1] - x_[0]).normalized();
  const double half_weight = 0.5 * kGravity * config_.density * linkLength(0);
  return (tension_[0] * t - half_weight * Eigen::Vector3d::UnitY()).norm();
}

Eigen::Vector3d TetherChain::contactPoint(const TetherContact& c) const noexcept {
  return (1.0 - c.s) * x_[at(c.link)] + c.s * x_[at(c.link + 1)];
}

double TetherChain::energy(double end_mass) const noexcept {
  double energy = 0.0;
  for (int i = 1; i <= n_; ++i) {
    const double length = 0.5 * (linkLength(i - 1) + (i < n_ ? linkLength(i) : 0.0));
    const double mass = config_.density * length + (i == n_ ? end_mass : 0.0);
    energy += mass * (0.5 * v_[at(i)].squaredNorm() + kGravity * x_[at(i)].y());
  }
  for (int j = 0; j < n_; ++j) {
    const double stretch = std::fmax(0.0, (x_[at(j + 1)] - x_[at(j)]).norm() - linkLength(j));
    energy += 0.5 * config_.axial_stiffness / linkLength(j) * stretch * stretch;
  }
  return energy;
}

}  // namespace tautline::sim
