#include "sim_hil/tether_chain.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tautline::sim {
namespace {

constexpr double kGravity = 9.81;        // [m/s^2]
constexpr double kAirDensity = 1.2;      // [kg/m^3]
constexpr double kContactMargin = 0.01;  // [m]
constexpr double kMaxBendDepth = 0.02;   // a link deeper in a solid is not bent round its edge [m]
constexpr double kHeldMass = 1e6;        // of a node that is held in space [kg]
constexpr double kCreep = 0.002;         // slip speed below which friction is viscous [m/s]

}  // namespace

TetherChain::TetherChain(const TetherConfig& config, const Eigen::Vector3d& p_WD, double L)
    : config_(config), n_(config.links), L_(L), mesh_(config.links) {
  for (int i = 0; i <= n_; ++i) {
    x_[at(i)] = p_WD * (static_cast<double>(i) / n_);
    v_[at(i)].setZero();
  }
}

void TetherChain::step(double h, double L, const EndLoad& end, const Eigen::Vector3d& wind,
                       const Obstacles& obstacles) noexcept {
  if (disturbance_.no_contacts) wrap_ = {};
  wrap_.update({x_.data(), at(n_ + 1)}, friction());
  moveMesh(h);
  const double L_rate = (L - L_) / h;
  L_ = L;
  x_old_ = x_;
  for (int i = 1; i <= n_; ++i) x_[at(i)] += h * v_[at(i)];
  findContacts(obstacles, L_rate);
  prepare(h, L_rate, end, wind);
  minimize(h, obstacles, end);
  for (int i = 1; i <= n_; ++i) v_[at(i)] = (x_[at(i)] - x_old_[at(i)]) / h;
  for (int j = 0; j < n_; ++j) {
    const double length = bent_[at(j)] ? way(j).length : (x_[at(j + 1)] - x_[at(j)]).norm();
    stretch_[at(j)] = std::fmax(0.0, length - linkLength(j));
  }
  const auto loaded = std::remove_if(face_.begin(), face_.begin() + face_count_,
                                     [](const FaceContact& c) { return c.force <= 0.0; });
  face_count_ = static_cast<int>(loaded - face_.begin());
}

TetherWrap::Way TetherChain::way(int link) const noexcept {
  return TetherWrap::wayOf(wrap_.on(link), x_[at(link)], x_[at(link + 1)]);
}

/// Centres bent links on their edges. A node that moves on the material is moved along the tether,
/// with the velocity of the material there: the tether itself does not notice.
void TetherChain::moveMesh(double h) noexcept {
  bent_.fill(false);
  mesh_.begin();
  for (const EdgeContact& bend : wrap_.all()) {
    if (bent_[at(bend.link)]) continue;
    bent_[at(bend.link)] = true;
    const TetherWrap::Way w = way(bend.link);
    const double between = w.length - w.first - w.last;
    mesh_.centre(bend.link, (w.first + 0.5 * between) / w.length, between / L_);
  }
  for (const FaceContact& c : faceContacts()) {
    if (c.feature >= kFirstEdge && !bent_[at(c.link)]) mesh_.centre(c.link, c.s, 0.0);
  }
  mesh_.update(h);
  const Nodes x = x_;
  const Nodes v = v_;
  for (int k = 1; k < n_; ++k) {
    const double shift = h * mesh_.rate(k) * L_;
    if (shift == 0.0) continue;
    const int link = shift > 0.0 ? k : k - 1;
    const TetherWrap::Way w = TetherWrap::wayOf(wrap_.on(link), x[at(link)], x[at(link + 1)]);
    x_[at(k)] += shift * (shift > 0.0 ? w.t_first : w.t_last);
    if (!bent_[at(link)]) {
      v_[at(k)] += std::abs(shift) / w.length * (v[at(shift > 0.0 ? k + 1 : k - 1)] - v[at(k)]);
    }
  }
}

void TetherChain::findContacts(const Obstacles& obstacles, double L_rate) noexcept {
  const std::array<FaceContact, kMaxFaceContacts> last = face_;
  const int last_count = face_count_;
  face_count_ = 0;
  if (obstacles.solids().empty() || disturbance_.no_contacts) return;
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
      if (obstacles.bounds(near[k]).overlaps(link, kContactMargin)) {
        touchSolid(obstacles, near[k], j);
      }
    }
  }
  for (FaceContact& c : std::span(face_.data(), at(face_count_))) {
    setFriction(c, {last.data(), at(last_count)}, L_rate);
  }
  bent_.fill(false);
  for (const EdgeContact& bend : wrap_.all()) bent_[at(bend.link)] = true;
}

void TetherChain::touchSolid(const Obstacles& obstacles, std::size_t solid, int link) noexcept {
  const ConvexPrism& prism = obstacles.solids()[solid];
  if (wrap_.touches(link, prism.obstacle, obstacles)) return;
  const Eigen::Vector3d& x_j = x_[at(link)];
  const Eigen::Vector3d& x_k = x_[at(link + 1)];
  std::array<SegmentContact, kMaxSegmentContacts> found;
  const int count = segmentContacts(prism, x_j, x_k, kContactMargin, found);
  for (int i = 0; i < count; ++i) {
    const SegmentContact& f = found[at(i)];
    const double depth = f.offset - f.normal.dot(x_j + f.s * (x_k - x_j));
    if (f.feature >= kFirstEdge && depth > 0.0 && depth < kMaxBendDepth) {
      wrap_.add(prism, static_cast<int>(solid), link, f, x_j, x_k);
    } else if (face_count_ < kMaxFaceContacts) {
      FaceContact& c = face_[at(face_count_++)];
      c = {};
      c.link = link;
      c.s = f.s;
      c.solid = static_cast<int>(solid);
      c.feature = f.feature;
      c.normal = f.normal;
      c.offset = f.offset;
    }
  }
}

/// Coulomb friction with the normal force of the last step; viscous while it creeps.
void TetherChain::setFriction(FaceContact& c, std::span<const FaceContact> last,
                              double L_rate) const noexcept {
  double force = 0.0;
  for (const FaceContact& old : last) {
    const bool same = old.solid == c.solid && std::abs(old.link - c.link) <= 1 &&
                      (old.feature == c.feature || old.link == c.link);
    if (same) force = std::fmax(force, old.force);
  }
  c.flow = (1.0 - mesh_.position(c.link) - c.s * mesh_.fraction(c.link)) * L_rate;
  const Eigen::Vector3d t = (x_[at(c.link + 1)] - x_[at(c.link)]).normalized();
  Eigen::Vector3d slip = (1.0 - c.s) * v_[at(c.link)] + c.s * v_[at(c.link + 1)] + c.flow * t;
  slip -= c.normal * c.normal.dot(slip);
  c.friction = friction() * force / std::fmax(slip.norm(), kCreep);
}

void TetherChain::prepare(double h, double L_rate, const EndLoad& end,
                          const Eigen::Vector3d& wind) noexcept {
  wind_ = wind;
  const double drag_per_length = 0.5 * kAirDensity * config_.drag_coefficient * config_.diameter;
  for (int i = 0; i <= n_; ++i) {
    flow_[at(i)] = (1.0 - mesh_.position(i)) * L_rate;
    if (i == 0) continue;
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
  if (const int held = disturbance_.held_node; held > 0) {
    mass_[at(held)] = kHeldMass;
    x_free_[at(held)] = x_old_[at(held)];
  }
  // Capstan law of bent links, T_drone / T_reel = exp(mu * turn) when sliding towards the drone, as
  // a viscous coefficient with the tension and the slip of the last step.
  for (int j = 0; j < n_; ++j) {
    const double limit =
        bent_[at(j)] ? 2.0 * tension_[at(j)] * std::tanh(0.5 * friction() * way(j).turn) : 0.0;
    rub_[at(j)] = limit / std::fmax(std::abs(slip_[at(j)]), kCreep);
    if (!bent_[at(j)]) slip_[at(j)] = rubbing_[at(j)] = 0.0;
  }
}

Eigen::Vector3d TetherChain::endTension() const noexcept {
  const int j = n_ - 1;
  const double half_weight = 0.5 * kGravity * config_.density * linkLength(j);
  return (tension_[at(j)] + 0.5 * rubbing_[at(j)]) * way(j).t_last +
         half_weight * Eigen::Vector3d::UnitY();
}

double TetherChain::reelTension() const noexcept {
  const double half_weight = 0.5 * kGravity * config_.density * linkLength(0);
  return ((tension_[0] - 0.5 * rubbing_[0]) * way(0).t_first -
          half_weight * Eigen::Vector3d::UnitY())
      .norm();
}

Eigen::Vector3d TetherChain::contactPoint(const FaceContact& c) const noexcept {
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
    const double stretch = std::fmax(0.0, way(j).length - linkLength(j));
    energy += 0.5 * config_.axial_stiffness / linkLength(j) * stretch * stretch;
  }
  return energy;
}

}  // namespace tautline::sim
