#pragma once

/// @file
/// The way flown since take-off, with the tether's contacts on each piece of it: what a way back
/// follows and undoes (docs/control.md). Not the plan but what was flown, by mission, by stick or
/// by drifting.
///
/// Real-time safe throughout: no allocation, no locks, no exceptions.

#include <array>

#include <Eigen/Core>

#include "common/mission_plan.h"
#include "control/contact_stack.h"

namespace tautline {

class FlownPath {
 public:
  static constexpr int kMaxPoints = 512;
  static constexpr int kMaxBends = 2 * kMaxContacts;  ///< Different contact stacks.
  static constexpr double kSpacing = 0.2;             ///< A new point after this much way [m].
  static constexpr double kTolerance = 0.05;  ///< A point this near to the straight line between
                                              ///< its neighbours is left out [m].
  static constexpr double kSamePlace = 0.2;   ///< Closer than this is where it has been before [m].
  static constexpr double kLeastLoop = 0.2;   ///< A way there that is longer than straight by less
                                              ///< than this is no loop [m].
  static constexpr double kOnTether = 0.3;  ///< Closer to the tether's line than this a contact is
                                            ///< made or comes off [m].

  /// No way home is known.
  void clear() noexcept { count_ = 0; }

  /// The way home ends at p_WHome [m], with the bare reel outlet as anchor.
  void begin(const Eigen::Vector3d& p_WHome) noexcept;

  /// The drone is at p_WD, on this stack; to be called in every cycle of a flight that does not go
  /// back. Where a contact was made or has come off there is a point of its own. With
  /// `tether_known` (it touches nothing but the contacts of the stack) a loop that ends where the
  /// drone has been before on the same stack is forgotten, and so is the way between a contact's
  /// making and its coming off. When full, the whole path is thinned further; with no room left
  /// even so, no way home is known any more.
  void record(const Eigen::Vector3d& p_WD, const ContactStack& contacts,
              bool tether_known) noexcept;

  /// The drone is going back to point i: what was beyond it has been undone. 0 <= i.
  void cutAfter(int i) noexcept;

  [[nodiscard]] bool known() const noexcept { return count_ > 0; }
  [[nodiscard]] int count() const noexcept { return count_; }

  /// Point 0 is above home. 0 <= i < count().
  [[nodiscard]] const Eigen::Vector3d& point(int i) const noexcept { return at(i).p_WD; }

  /// Where a drone at p_WD joins the path: its last point, or one before it on the same stack if
  /// the straight way there is as good as flown: it passes all points between within kSamePlace.
  /// known() only.
  [[nodiscard]] int joinFrom(const Eigen::Vector3d& p_WD) const noexcept;

  /// Id of the contact that was active on the way from point i - 1 to point i. 0 < i < count().
  [[nodiscard]] int contact(int i) const noexcept { return bend(at(i).bend).id; }

  /// Makes `contacts` what they were on that way; kNone or an error of ContactStack.
  [[nodiscard]] ContactStack::Change restore(int i, ContactStack& contacts) const noexcept;

 private:
  /// A contact and those below it: the stacks that occurred, as a tree. 0 is the reel outlet.
  struct Bend {
    int id{kReelContact};
    Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};
    int below{0};  ///< Always less than its own index.
  };
  struct Point {
    Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
    int bend{0};        ///< Of the piece that ends here.
    double error{0.0};  ///< No point left out on that piece was farther from it [m].
  };

  [[nodiscard]] const Point& at(int i) const noexcept {
    return points_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] const Bend& bend(int i) const noexcept {
    return bends_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] int bendOf(const ContactStack& contacts) noexcept;
  void append(Point point) noexcept;
  void forgetLoop(const Eigen::Vector3d& p_WD) noexcept;
  void forgetContact(int bend_before) noexcept;
  void cutTo(int count, const Point& last) noexcept;
  void thin(double tolerance) noexcept;
  void dropUnusedBends() noexcept;

  std::array<Point, kMaxPoints> points_{};
  std::array<Bend, kMaxBends> bends_{};
  int count_{0};
  int bend_count_{1};
  int bend_{0};  ///< Of the piece that is being flown.
};

}  // namespace tautline
