#include "planning_offline/tether/contact_plan.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "planning_offline/tether/sliding_string.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

// [cells]
constexpr double kSample = 0.5;
constexpr double kEventPlace = 1e-6;
constexpr double kLegEnd = 2e-3;
constexpr double kSameContact = 1e-3;

using Points = std::vector<Eigen::Vector3d>;

double lengthAlong(const Eigen::Vector3d& reel, const Points& contacts,
                   const Eigen::Vector3d& vehicle) {
  double length = 0.0;
  Eigen::Vector3d last = reel;
  for (const Eigen::Vector3d& contact : contacts) {
    length += (contact - last).norm();
    last = contact;
  }
  return length + (vehicle - last).norm();
}

/// How many contacts from the reel on are the same.
std::size_t commonPart(const Points& a, const Points& b, double tolerance) {
  std::size_t n = 0;
  while (n < a.size() && n < b.size() && (a[n] - b[n]).norm() <= tolerance) ++n;
  return n;
}

bool same(const Points& a, const Points& b, double tolerance) {
  return a.size() == b.size() && commonPart(a, b, tolerance) == a.size();
}

/// Changes of one stack, each with its place: what pops and pushes turn it into another.
class StackLog {
 public:
  StackLog(const Eigen::Vector3d& reel, double resolution)
      : reel_(reel), tolerance_(kSameContact * resolution) {}

  [[nodiscard]] bool is(const Points& contacts) const {
    return same(contacts_, contacts, tolerance_);
  }

  void changeTo(const Points& contacts, const Eigen::Vector3d& vehicle) {
    const std::size_t kept = commonPart(contacts_, contacts, tolerance_);
    double before = lengthAlong(reel_, contacts_, vehicle);
    const auto add = [&](ContactChange kind, const Eigen::Vector3d& contact) {
      const double length = lengthAlong(reel_, contacts_, vehicle);
      events_.push_back({kind, contact, vehicle, before, length});
      before = length;
    };
    while (contacts_.size() > kept) {
      const Eigen::Vector3d contact = contacts_.back();
      contacts_.pop_back();
      add(ContactChange::kPop, contact);
    }
    for (std::size_t i = kept; i < contacts.size(); ++i) {
      contacts_.push_back(contacts[i]);
      add(ContactChange::kPush, contacts[i]);
    }
  }

  [[nodiscard]] std::vector<ContactEvent> take() { return std::exchange(events_, {}); }

 private:
  Eigen::Vector3d reel_;
  double tolerance_;
  Points contacts_;
  std::vector<ContactEvent> events_;
};

/// Flies the taut string along a path.
class ExactFlight {
 public:
  ExactFlight(const VoxelMap& map, const Eigen::Vector3d& reel)
      : string_(makeTautString(map, reel)),
        cell_(map.resolution),
        log_(string_->reel(), map.resolution) {}

  [[nodiscard]] TetherState begin(const Eigen::Vector3d& position) {
    arrive(string_->reel(), position);
    log_.changeTo(string_->contacts(stack_), position);
    return state(position);
  }

  [[nodiscard]] TetherState flyTo(const Eigen::Vector3d& position) {
    const Leg leg{stack_, last_, position};
    arrive(last_, position);
    logEvents(leg);
    return state(position);
  }

  [[nodiscard]] std::int64_t unresolved() const noexcept { return unresolved_; }

 private:
  struct Leg {
    StackId stack;
    Eigen::Vector3d from;
    Eigen::Vector3d to;
    [[nodiscard]] Eigen::Vector3d at(double part) const { return from + part * (to - from); }
  };

  void arrive(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const std::int64_t before = string_->unresolvedMoves();
    stack_ = string_->move(stack_, from, to);
    unresolved_ += string_->unresolvedMoves() - before;
    last_ = to;
  }

  [[nodiscard]] TetherState state(const Eigen::Vector3d& position) {
    return {.position = position,
            .contacts = string_->contacts(stack_),
            .length = string_->length(stack_, position),
            .events = log_.take()};
  }

  [[nodiscard]] Points contactsAt(const Leg& leg, double part) {
    return string_->contacts(part < 1.0 ? string_->move(leg.stack, leg.from, leg.at(part))
                                        : stack_);
  }

  void logEvents(const Leg& leg) {
    const double cells = (leg.to - leg.from).norm() / cell_;
    const int samples = std::max(1, static_cast<int>(std::ceil(cells / kSample)));
    double done = 0.0;
    for (int k = 1; k <= samples; ++k) {
      const double end = static_cast<double>(k) / samples;
      const Points there = contactsAt(leg, end);
      // Each change is looked for behind the one before.
      while (!log_.is(there)) done = logFirst(leg, done, end, there, cells);
      done = end;
    }
  }

  /// Logs the first change in parts low … high of the leg and returns its part. At the end of the
  /// range the stack is `there`, another than now.
  double logFirst(const Leg& leg, double low, double high, Points there, double cells) {
    while ((high - low) * cells > kEventPlace) {
      const double middle = 0.5 * (low + high);
      Points between = contactsAt(leg, middle);
      if (log_.is(between)) {
        low = middle;
      } else {
        high = middle;
        there = std::move(between);
      }
    }
    Eigen::Vector3d vehicle = leg.at(high);
    if (high * cells < kLegEnd) vehicle = leg.from;
    if ((1.0 - high) * cells < kLegEnd) vehicle = leg.to;
    log_.changeTo(there, vehicle);
    return high;
  }

  std::unique_ptr<TautString> string_;
  double cell_;
  StackLog log_;
  StackId stack_{kStraight};
  Eigen::Vector3d last_{Eigen::Vector3d::Zero()};
  std::int64_t unresolved_{0};
};

void flyExact(const VoxelMap& map, const Eigen::Vector3d& reel,
              std::span<const Eigen::Vector3d> path, ContactPlan& plan) {
  ExactFlight flight(map, reel);
  for (const Eigen::Vector3d& position : path) {
    plan.states.push_back(plan.states.empty() ? flight.begin(position) : flight.flyTo(position));
  }
  plan.unresolved_moves = flight.unresolved();
}

/// In the plane the string is frictionless itself.
void addFrictionless(const VoxelMap& map, const Eigen::Vector3d& reel, ContactPlan& plan) {
  if (map.shape.planar()) {
    for (TetherState& state : plan.states) state.frictionless_length = state.length;
    return;
  }
  SlidingString string(map, reel);
  for (TetherState& state : plan.states) {
    string.moveTo(state.position);
    if (string.unresolvedMoves() > 0) return;
    state.frictionless_length = string.length();
  }
}

void flyAsPublished(const VoxelMap& map, const Eigen::Vector3d& reel,
                    std::span<const Eigen::Vector3d> path, const PublishedOptions& options,
                    ContactPlan& plan) {
  StackLog log(reel, map.resolution);
  for (const PublishedState& state : publishedContacts(map, reel, path, options)) {
    const Eigen::Vector3d& position = path[plan.states.size()];
    log.changeTo(state.contacts, position);
    plan.states.push_back({.position = position,
                           .contacts = state.contacts,
                           .length = lengthAlong(reel, state.contacts, position),
                           .events = log.take(),
                           .relaxation_refused = state.relaxation_refused,
                           .pierces = state.pierces});
  }
}

}  // namespace

ContactPlan planContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                         std::span<const Eigen::Vector3d> path, const ContactOptions& options) {
  ContactPlan plan{.algorithm = options.algorithm};
  switch (options.algorithm) {
    case ContactAlgorithm::kExact:
      flyExact(map, reel, path, plan);
      if (options.frictionless) addFrictionless(map, reel, plan);
      break;
    case ContactAlgorithm::kAsPublished:
      flyAsPublished(map, reel, path, options.published, plan);
      break;
  }
  return plan;
}

double longestTether(const ContactPlan& plan) {
  double longest = 0.0;
  for (const TetherState& state : plan.states) {
    longest = std::max(longest, state.length);
    for (const ContactEvent& event : state.events) longest = std::max(longest, event.longest());
  }
  return longest;
}

int countEvents(const ContactPlan& plan, ContactChange kind) {
  int count = 0;
  for (const TetherState& state : plan.states) {
    for (const ContactEvent& event : state.events) count += event.kind == kind ? 1 : 0;
  }
  return count;
}

}  // namespace tautline::planning
