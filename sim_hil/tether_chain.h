#pragma once

/// @file
/// The tether's own physics: a chain of lumped masses from the reel outlet to the drone, with the
/// drone as its last mass, so that the tension on both ends is part of one solution.
///
/// Model (docs/simulator.md): links that resist stretching but not compression (Kelvin-Voigt, EA
/// and a damping time), weight, air drag; links bent round edges with the capstan law
/// (tether_wrap.h); faces and floor as stiff one-sided springs with Coulomb friction. One step is
/// backward Euler, solved as the minimum of the convex incremental potential by Newton's method on
/// the block-tridiagonal Hessian: stable at any tension, mass ratio and step, and it never adds
/// energy.
///
/// The reel changes the unstretched length L, which the links share (tether_mesh.h). Material then
/// flows through the nodes, and friction acts on the material, not on the nodes.

#include <array>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "common/fields.h"
#include "sim_hil/obstacles.h"
#include "sim_hil/tether_contact.h"
#include "sim_hil/tether_mesh.h"
#include "sim_hil/tether_wrap.h"

namespace tautline::sim {

struct TetherConfig {
  int links{24};
  double density{0.0061};            ///< [kg/m]
  double axial_stiffness{1e4};       ///< EA [N]
  double axial_damping_time{0.004};  ///< Damping over stiffness [s].
  double diameter{0.002};            ///< [m]
  double drag_coefficient{1.1};      ///< Of a cylinder across the flow.
  double internal_damping{0.006};    ///< Bending losses, as viscous drag per length [N s/m^2].
  double friction{0.3};              ///< Coulomb, on obstacles.
  double floor_friction{0.4};
  double contact_stiffness{5000.0};  ///< Of an obstacle's surface under one contact [N/m].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("links", links, Range{4, kMaxLinks}, "lumped links from reel to drone");
    v.field("density_kg_per_m", density, Range{1e-4, 0.1}, "mass per length");
    v.field("axial_stiffness_n", axial_stiffness, Range{100, 1e6}, "EA");
    v.field("axial_damping_time_s", axial_damping_time, Range{0, 0.1}, "damping over stiffness");
    v.field("diameter_m", diameter, Range{1e-4, 0.02}, "for air drag");
    v.field("drag_coefficient", drag_coefficient, Range{0, 3}, "cylinder across the flow");
    v.field("internal_damping_ns_per_m2", internal_damping, Range{0, 1},
            "bending losses, as viscous drag per length");
    v.field("friction", friction, Range{0, 1.5}, "Coulomb coefficient on obstacles");
    v.field("floor_friction", floor_friction, Range{0, 1.5}, "Coulomb coefficient on the floor");
    v.field("contact_stiffness_n_per_m", contact_stiffness, Range{100, 1e5},
            "of an obstacle's surface under one contact");
  }
};

/// What acts on the last mass, the drone, during one step.
struct EndLoad {
  double mass{0.618};                              ///< [kg]
  Eigen::Vector3d force{Eigen::Vector3d::Zero()};  ///< Without drag and tether [N], with weight.
  double drag{0.0};                                ///< [N/(m/s)], relative to the wind.
  double ground{-1e9};                             ///< Lowest height the attachment can have [m].
};

/// What is wrong with the tether, or with what holds it.
struct TetherDisturbance {
  int held_node{0};                ///< Held in space where it is; 0 none (the outlet always is).
  int cut_link{-1};                ///< Carries no force; -1 none.
  std::optional<double> friction;  ///< On obstacles instead of the configured one.
  bool no_contacts{false};         ///< Obstacles do not hold the tether.
};

class TetherChain {
 public:
  /// Straight from the outlet at the origin to `p_WD`, at rest, with unstretched length `L` > 0.
  /// `config` must have passed its ranges.
  TetherChain(const TetherConfig& config, const Eigen::Vector3d& p_WD, double L);

  /// Advances by h [s]; afterwards the unstretched length is `L` [m]. `wind` is the air's velocity
  /// [m/s]. Real-time safe: no allocation, no locks, no exceptions.
  void step(double h, double L, const EndLoad& end, const Eigen::Vector3d& wind,
            const Obstacles& obstacles) noexcept;

  /// In force until the next call.
  void disturb(const TetherDisturbance& disturbance) noexcept { disturbance_ = disturbance; }
  [[nodiscard]] int cutLink() const noexcept { return disturbance_.cut_link; }

  [[nodiscard]] int linkCount() const noexcept { return n_; }
  [[nodiscard]] const Eigen::Vector3d& position(int node) const noexcept { return x_[at(node)]; }
  [[nodiscard]] const Eigen::Vector3d& velocity(int node) const noexcept { return v_[at(node)]; }
  [[nodiscard]] double length() const noexcept { return L_; }

  /// Tether force that pulls the drone, reversed: along the tangent, outward; its norm is the
  /// tension at the drone [N]. A slack tether hangs: the force then points up.
  [[nodiscard]] Eigen::Vector3d endTension() const noexcept;
  /// Tension at the outlet [N].
  [[nodiscard]] double reelTension() const noexcept;
  /// Mean over the link, where it is bent [N].
  [[nodiscard]] double linkTension(int link) const noexcept { return tension_[at(link)]; }

  /// Where the tether is bent round an edge, from reel to drone.
  [[nodiscard]] std::span<const EdgeContact> bends() const noexcept { return wrap_.all(); }
  /// Where it lies on a face and carries a force, from reel to drone.
  [[nodiscard]] std::span<const FaceContact> faceContacts() const noexcept {
    return {face_.data(), at(face_count_)};
  }
  [[nodiscard]] Eigen::Vector3d contactPoint(const FaceContact& c) const noexcept;
  /// Normal force of the ground on the drone [N].
  [[nodiscard]] double groundForce() const noexcept { return ground_force_[at(n_)]; }

  /// Kinetic + potential (zero at height 0) + elastic energy of chain and drone [J].
  [[nodiscard]] double energy(double end_mass) const noexcept;

  /// Newton iterations of the last step, for benchmarks and tests.
  [[nodiscard]] int iterations() const noexcept { return iterations_; }

 private:
  using Nodes = std::array<Eigen::Vector3d, kMaxLinks + 1>;
  using Blocks = std::array<Eigen::Matrix3d, kMaxLinks + 1>;

  static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] double linkLength(int link) const noexcept { return mesh_.fraction(link) * L_; }
  [[nodiscard]] TetherWrap::Way way(int link) const noexcept;
  [[nodiscard]] double friction() const noexcept {
    return disturbance_.friction.value_or(config_.friction);
  }

  // tether_chain.cpp
  void moveMesh(double h) noexcept;
  void findContacts(const Obstacles& obstacles, double L_rate) noexcept;
  void touchSolid(const Obstacles& obstacles, std::size_t solid, int link) noexcept;
  void setFriction(FaceContact& contact, std::span<const FaceContact> last,
                   double L_rate) const noexcept;
  void prepare(double h, double L_rate, const EndLoad& end, const Eigen::Vector3d& wind) noexcept;

  // tether_newton.cpp
  void minimize(double h, const Obstacles& obstacles, const EndLoad& end) noexcept;
  void searchLine(double h, const Obstacles& obstacles, const EndLoad& end) noexcept;
  void assemble(double h, const Obstacles& obstacles, const EndLoad& end) noexcept;
  void assembleLinks(double h) noexcept;
  void assembleBentLink(double h, int link) noexcept;
  [[nodiscard]] double linkForce(double h, int link, double length,
                                 double& stiffness) const noexcept;
  void assembleGround(double h, double floor, double end_ground) noexcept;
  void assembleFaces(double h) noexcept;
  [[nodiscard]] double residual() const noexcept;
  void solve() noexcept;

  TetherConfig config_;
  TetherDisturbance disturbance_;
  int n_;
  double L_;
  TetherMesh mesh_;
  TetherWrap wrap_;
  Nodes x_{};
  Nodes v_{};
  NodeScalars tension_{};
  NodeScalars rubbing_{};  // tension at a bent link's end towards the drone minus that at its start
  NodeScalars stretch_{};  // elongation at the end of the last step, not negative
  NodeScalars slip_{};     // speed of the material round a link's bends, towards the drone [m/s]
  std::array<bool, kMaxLinks> bent_{};
  std::array<FaceContact, kMaxFaceContacts> face_{};
  int face_count_{0};

  // One step's work space.
  Nodes x_old_{};
  Nodes x_free_{};  // where a mass would go without tether and contacts
  Nodes gradient_{};
  Nodes direction_{};
  NodeScalars mass_{};
  NodeScalars drag_{};
  NodeScalars rub_{};   // friction of a bent link over its slip [N s/m]
  NodeScalars flow_{};  // of the material past each node, towards the drone [m/s]
  NodeScalars ground_force_{};
  NodeScalars ground_friction_{};
  Eigen::Vector3d wind_{Eigen::Vector3d::Zero()};
  Blocks diagonal_{};
  Blocks coupling_{};  // row node i, column node i + 1
  int iterations_{0};
};

}  // namespace tautline::sim
