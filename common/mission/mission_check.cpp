#include "common/mission/mission_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "common/catenary.h"
#include "common/tether_geometry.h"

namespace tautline {
namespace {

constexpr double kGravity = 9.81;         // [m/s^2]
constexpr double kPathStep = 0.05;        // [m], sampling of what moves along a segment
constexpr double kCutStep = 0.01;         // [m], sampling of the tether inside an obstacle
constexpr double kSamePlace = 1e-6;       // [m]
constexpr double kSceneTolerance = 0.01;  // [m], mission's reel against the scene's
constexpr double kOnSurface = 0.02;       // [m], contact against its obstacle

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::string metres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f m", value);
  return text.data();
}

std::string degrees(double angle) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f deg", angle * 180.0 / std::numbers::pi);
  return text.data();
}

std::string newtons(double force) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f N", force);
  return text.data();
}

std::string anchorName(int contact) {
  return contact == kReelContact ? "the reel" : "contact " + std::to_string(contact);
}

double distanceToSegment(const Eigen::Vector3d& x, const Eigen::Vector3d& p,
                         const Eigen::Vector3d& q) {
  const Eigen::Vector3d d = q - p;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((x - p).dot(d) / length2, 0.0, 1.0) : 0.0;
  return (p + t * d - x).norm();
}

/// Free and static tether with everything straight: what the reel has paid out at a point.
double tautLength(const MissionPlan& plan, const std::vector<int>& stack,
                  const Eigen::Vector3d& p_WD) {
  const int anchor = stack.empty() ? kReelContact : stack.back();
  return staticLength(plan, stack) + (p_WD - anchorPosition(plan, anchor)).norm();
}

/// The point of the segment p-q that is nearest to the vertical line through x.
Eigen::Vector3d nearestToVertical(const Eigen::Vector3d& x, const Eigen::Vector3d& p,
                                  const Eigen::Vector3d& q) {
  const Eigen::Vector3d d = q - p;
  const double length2 = d.x() * d.x() + d.z() * d.z();
  if (length2 == 0.0) return q;
  const double t = ((x.x() - p.x()) * d.x() + (x.z() - p.z()) * d.z()) / length2;
  return p + std::clamp(t, 0.0, 1.0) * d;
}

class Checker {
 public:
  Checker(const Mission& mission, const MissionLimits& limits, const Scene* scene)
      : mission_(mission), plan_(*mission.plan), limits_(limits), stacks_(contactStacks(plan_)) {
    if (scene != nullptr) scene_ = sceneInWorld(*scene);
    floor_ = scene_ ? scene_->floor : -mission.reel_position.y();
    if (scene != nullptr) checkReel(*scene);
  }

  std::vector<MissionFinding> run() {
    for (int i = 0; i < plan_.contact_count; ++i) checkContact(i);
    for (int i = 0; i < plan_.waypoint_count; ++i) {
      row_ = "waypoints[" + std::to_string(i) + "]";
      checkWaypoint(i);
      if (i == 0) {
        checkFirst();
      } else {
        checkSwitch(i);
        checkSegment(i);
      }
      if (scene_) checkObstacles(i);
    }
    return std::move(findings_);
  }

 private:
  void add(FindingSeverity severity, std::string text, std::string remedy = {}) {
    findings_.push_back({severity, row_, std::move(text), std::move(remedy)});
  }

  [[nodiscard]] const Eigen::Vector3d& position(int i) const { return plan_.waypoints[at(i)].p_WD; }
  [[nodiscard]] Eigen::Vector3d anchor(int i) const {
    return anchorPosition(plan_, plan_.waypoints[at(i)].contact);
  }
  [[nodiscard]] std::string name(int i) const { return anchorName(plan_.waypoints[at(i)].contact); }

  void checkReel(const Scene& scene) {
    const double difference = (scene.reel - mission_.reel_position).norm();
    if (difference > kSceneTolerance) {
      add(FindingSeverity::kError,
          "reel_position_m is " + metres(difference) + " from the reel of scene '" + scene.name +
              "'",
          "check against the scene that the mission was made for");
    }
    if (!mission_.map_hash.empty() && mission_.map_hash != hashText(scene.hash)) {
      add(FindingSeverity::kWarning,
          "scene '" + scene.name + "' has changed since the mission was made: its hash is " +
              hashText(scene.hash) + ", map_hash says " + mission_.map_hash,
          "check the findings below, then update map_hash");
    }
  }

  void checkContact(int i) {
    const MissionContact& contact = plan_.contacts[at(i)];
    row_ = "contacts[" + std::to_string(i) + "]";
    const bool used =
        std::any_of(stacks_.begin(), stacks_.end(), [&](const std::vector<int>& stack) {
          return std::find(stack.begin(), stack.end(), contact.id) != stack.end();
        });
    if (!used)
      add(FindingSeverity::kWarning, "no waypoint uses " + anchorName(contact.id), "remove it");
    if (!scene_) return;
    const double distance = clearance(contact.p_WC, *scene_);
    if (std::abs(distance) > kOnSurface) {
      add(FindingSeverity::kError,
          distance < 0.0 ? metres(-distance) + " inside an obstacle"
                         : "no obstacle within " + metres(kOnSurface),
          "move it to the edge that the tether will touch");
    }
    checkSharp(contact.p_WC, scene_->boxes);
    checkSharp(contact.p_WC, scene_->prisms);
  }

  template <class Obstacle>
  void checkSharp(const Eigen::Vector3d& p_WC, const std::vector<Obstacle>& obstacles) {
    for (const Obstacle& obstacle : obstacles) {
      if (!obstacle.sharp || std::abs(signedDistance(p_WC, obstacle)) > kOnSurface) continue;
      add(FindingSeverity::kError, "touches the sharp obstacle '" + obstacle.name + "'",
          "plan a way whose tether does not");
    }
  }

  void checkFirst() {
    const TetherCoordinates tether = toTether(position(0));
    if (tether.L <= limits_.anchor_margin) return;  // already reported
    if (plan_.waypoints[0].contact != kReelContact) {
      add(FindingSeverity::kError, "starts with " + name(0) + " formed",
          "start with contact 0: the drone takes off at the reel");
    }
    if (tether.theta < limits_.first_elevation_min || tether.theta > limits_.first_elevation_max) {
      add(FindingSeverity::kError,
          "elevation " + degrees(tether.theta) + " from the reel is not reachable after take-off",
          "between " + degrees(limits_.first_elevation_min) + " and " +
              degrees(limits_.first_elevation_max));
    }
  }

  void checkWaypoint(int i) {
    const Eigen::Vector3d p_AD = position(i) - anchor(i);
    const double distance = p_AD.norm();
    if (distance < limits_.anchor_margin) {
      add(FindingSeverity::kError, metres(distance) + " from " + name(i),
          "at least " + metres(limits_.anchor_margin));
    } else if (distance < limits_.tether_length_min) {
      add(FindingSeverity::kError, "free tether " + metres(distance),
          "at least " + metres(limits_.tether_length_min));
    }
    if (position(i).y() < floor_ + limits_.floor_margin) {
      add(FindingSeverity::kError, metres(position(i).y() - floor_) + " above the floor",
          "at least " + metres(limits_.floor_margin));
    }
    checkTether(i, p_AD);
  }

  void checkTether(int i, const Eigen::Vector3d& p_AD) {
    const double w = limits_.tether_density * kGravity;
    const double r = std::hypot(p_AD.x(), p_AD.z());
    const CatenaryInverse tether = solveInverseCatenary(r, p_AD.y(), limits_.tension, w);
    if (tether.status == CatenaryStatus::kNotReachable) {
      add(FindingSeverity::kError,
          "cannot be held at " + newtons(limits_.tension) + ": the tether's weight needs " +
              newtons(tether.T_min),
          "a higher point, a shorter tether or more tension");
      return;
    }
    const double total = staticLength(plan_, stacks_[at(i)]) + tether.L;
    if (total > limits_.tether_length_max) {
      add(FindingSeverity::kError, "needs " + metres(total) + " of tether",
          "at most " + metres(limits_.tether_length_max));
    }
    const double lowest =
        anchor(i).y() - (tether.dips_below_anchor ? (tether.T_A - tether.H) / w : 0.0);
    if (tether.dips_below_anchor && lowest < floor_) {
      add(FindingSeverity::kWarning,
          "at " + newtons(limits_.tension) + " the tether sags onto the floor",
          "a higher point or more tension");
    }
  }

  /// The drone does not move to the waypoint and does not stay: one of several changes of anchor at
  /// one place, which count as one.
  [[nodiscard]] bool onlySwitches(int i) const {
    return i > 0 && i + 1 < plan_.waypoint_count && plan_.waypoints[at(i)].hold <= 0.0 &&
           stacks_[at(i)] != stacks_[at(i + 1)] &&
           (position(i) - position(i - 1)).norm() < kSamePlace;
  }

  /// A change of anchor happens at the waypoint before; the paid-out length must hardly change
  /// there.
  void checkSwitch(int i) {
    const std::vector<int>& before = stacks_[at(i - 1)];
    const std::vector<int>& after = stacks_[at(i)];
    if (before == after) return;
    const std::size_t popped = before.size() > after.size() ? before.size() - after.size() : 0;
    int flown = i - 1;
    while (onlySwitches(flown)) --flown;
    const double jump = tautLength(plan_, after, position(i - 1)) -
                        tautLength(plan_, stacks_[at(flown)], position(i - 1));
    add(FindingSeverity::kInfo, (popped > 0 ? "relaxes to " : "forms ") + name(i) +
                                    ", tether length changes by " + metres(std::abs(jump)));
    if (std::abs(jump) > limits_.switch_jump && !onlySwitches(i)) {
      add(FindingSeverity::kWarning,
          "the tether does not lie on " + name(i) +
              " when it becomes the anchor: length jumps by " + metres(std::abs(jump)),
          "change the contact at a waypoint in line with both anchors");
    }
    if (popped > 1)
      add(FindingSeverity::kWarning, "relaxes " + std::to_string(popped) + " contacts at once",
          "relax one a waypoint");
  }

  void checkSegment(int i) {
    const Eigen::Vector3d& p = position(i - 1);
    const Eigen::Vector3d& q = position(i);
    if ((p - q).norm() < kSamePlace) {
      // Where only the contact changes the drone does not fly.
      if (stacks_[at(i)] == stacks_[at(i - 1)])
        add(FindingSeverity::kWarning, "same position as the waypoint before",
            "use hold_s to stay there");
      return;
    }
    const double nearest = distanceToSegment(anchor(i), p, q);
    const bool reported = (q - anchor(i)).norm() < limits_.anchor_margin;
    if (nearest < limits_.anchor_margin && !reported) {
      add(FindingSeverity::kError,
          "on the way the drone passes " + metres(nearest) + " from " + name(i),
          "at least " + metres(limits_.anchor_margin));
    }
    checkPole(i);
  }

  /// Horizontal distance from the vertical above the anchor on the way to waypoint i; infinite
  /// below the anchor.
  [[nodiscard]] double poleRadius(int i) const {
    const Eigen::Vector3d over =
        nearestToVertical(anchor(i), position(i - 1), position(i)) - anchor(i);
    return over.y() > 0.0 ? std::hypot(over.x(), over.z())
                          : std::numeric_limits<double>::infinity();
  }

  /// One finding for each visit to the pole, at the row where it begins.
  void checkPole(int i) {
    double radius = poleRadius(i);
    if (radius >= limits_.pole_radius || (i > 1 && poleRadius(i - 1) < limits_.pole_radius)) return;
    for (int k = i + 1; k < plan_.waypoint_count; ++k) {
      const double next = poleRadius(k);
      if (next >= limits_.pole_radius) break;
      radius = std::min(radius, next);
    }
    add(FindingSeverity::kInfo,
        "the drone comes within " + metres(radius) + " of the pole, the vertical above " + name(i));
  }

  void checkObstacles(int i) {
    const Eigen::Vector3d& q = position(i);
    const Eigen::Vector3d p = i == 0 ? q : position(i - 1);
    const double to_walls = std::min((q - scene_->min).minCoeff(), (scene_->max - q).minCoeff());
    if (to_walls < 0.0) {
      add(FindingSeverity::kError, "outside the room of scene '" + scene_->name + "'",
          "inside its min_m and max_m");
    } else if (scene_->max.y() - q.y() < limits_.floor_margin) {
      add(FindingSeverity::kError, metres(scene_->max.y() - q.y()) + " below the ceiling",
          "at least " + metres(limits_.floor_margin));
    }
    if (clearance(q, *scene_) < 0.0) {
      add(FindingSeverity::kError, "inside an obstacle", "move it out");
      return;
    }
    if (const auto hit = firstHit(p, q, *scene_)) {
      add(FindingSeverity::kError,
          "the way from the waypoint before leads through obstacle '" + hit->obstacle + "'",
          "fly round it");
      return;
    }
    checkClearance(p, q);
    if (!onlySwitches(i)) checkTetherCut(i, p, q);
  }

  void checkClearance(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    const int steps = std::max(1, static_cast<int>(std::ceil((q - p).norm() / kPathStep)));
    double nearest = std::numeric_limits<double>::max();
    for (int k = 0; k <= steps; ++k) {
      const Eigen::Vector3d x = p + (q - p) * k / steps;
      const Eigen::Vector3d low = x - scene_->min;
      const Eigen::Vector3d high = scene_->max - x;
      nearest = std::min({nearest, clearance(x, *scene_), low.x(), low.z(), high.x(), high.z()});
    }
    if (nearest < limits_.obstacle_margin) {
      add(FindingSeverity::kWarning,
          "the drone comes within " + metres(nearest) + " of an obstacle or wall",
          "at least " + metres(limits_.obstacle_margin));
    }
  }

  /// The straight tether from the active anchor, while the drone flies from p to q.
  void checkTetherCut(int i, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    const int steps = std::max(1, static_cast<int>(std::ceil((q - p).norm() / kPathStep)));
    double deepest = 0.0;
    std::string obstacle;
    for (int k = 0; k <= steps; ++k) {
      std::string found;
      const double depth = cutDepth(anchor(i), p + (q - p) * k / steps, *scene_, &found);
      if (depth > deepest) {
        deepest = depth;
        obstacle = found;
      }
    }
    if (deepest > limits_.tether_cut) {
      add(FindingSeverity::kError,
          "the tether from " + name(i) + " cuts " + metres(deepest) + " into obstacle '" +
              obstacle + "' on the way",
          "form a contact on that obstacle, or relax later");
    }
  }

  const Mission& mission_;
  const MissionPlan& plan_;
  MissionLimits limits_;
  std::vector<std::vector<int>> stacks_;
  std::optional<Scene> scene_;  // in W
  double floor_{0.0};
  std::string row_;
  std::vector<MissionFinding> findings_;
};

}  // namespace

std::vector<MissionFinding> checkMission(const Mission& mission, const MissionLimits& limits,
                                         const Scene* scene) {
  return Checker(mission, limits, scene).run();
}

bool isFlyable(const std::vector<MissionFinding>& findings) noexcept {
  return std::none_of(findings.begin(), findings.end(), [](const MissionFinding& finding) {
    return finding.severity == FindingSeverity::kError;
  });
}

double cutDepth(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Scene& scene,
                std::string* obstacle) {
  double deepest = 0.0;
  const auto probe = [&](const auto& obstacles) {
    for (const auto& solid : obstacles) {
      const std::optional<SegmentHit> hit = intersect(p, q, solid);
      if (!hit) continue;
      const double length = (hit->t_out - hit->t_in) * (q - p).norm();
      const int steps = std::max(2, static_cast<int>(std::ceil(length / kCutStep)));
      for (int k = 0; k <= steps; ++k) {
        const double t = hit->t_in + (hit->t_out - hit->t_in) * k / steps;
        const double depth = -signedDistance(Eigen::Vector3d(p + t * (q - p)), solid);
        if (depth <= deepest) continue;
        deepest = depth;
        if (obstacle != nullptr) *obstacle = solid.name;
      }
    }
  };
  probe(scene.boxes);
  probe(scene.prisms);
  return deepest;
}

std::optional<Scene> findScene(const Mission& mission, const std::filesystem::path& mission_file,
                               const std::string& scene_file) {
  if (!scene_file.empty()) return readScene(scene_file);
  if (!mission.map.ends_with(".scene.toml")) return std::nullopt;
  return readScene((mission_file.parent_path() / mission.map).lexically_normal());
}

}  // namespace tautline
