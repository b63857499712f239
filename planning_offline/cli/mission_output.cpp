#include "planning_offline/cli/mission_output.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "common/error.h"

namespace tautline::planning {
namespace {

/// Writes waypoints one after the other, each with the contact that is the anchor on the way to it.
class MissionWriter {
 public:
  MissionWriter(Mission& mission, std::string file)
      : reel_(mission.reel_position), plan_(*mission.plan), file_(std::move(file)) {}

  void flyTo(const Eigen::Vector3d& position, const Waypoint& like) {
    std::vector<int> ways = changes();
    if (ways.empty()) ways.push_back(anchorOf(flown_));
    // All changes but the last need a waypoint of their own where the vehicle is.
    for (std::size_t i = 0; i + 1 < ways.size(); ++i) {
      Waypoint here = plan_.waypoints[static_cast<std::size_t>(plan_.waypoint_count - 1)];
      here.hold = 0.0;
      here.contact = ways[i];
      add(here);
    }
    Waypoint there = like;
    there.p_WD = position - reel_;
    there.contact = ways.back();
    add(there);
    flown_ = wanted();
  }

  void apply(const ContactEvent& event) {
    if (event.kind == ContactChange::kPop) {
      stack_.pop_back();
    } else {
      stack_.push_back(idOf(event.position - reel_));
    }
  }

 private:
  static constexpr int kLeftOut = -1;
  static constexpr double kSamePlace = 1e-3;  // [m]: what mission files take for one place

  [[nodiscard]] static int anchorOf(const std::vector<int>& stack) {
    return stack.empty() ? kReelContact : stack.back();
  }

  [[nodiscard]] std::vector<int> wanted() const {
    std::vector<int> ids;
    std::copy_if(stack_.begin(), stack_.end(), std::back_inserter(ids),
                 [](int id) { return id != kLeftOut; });
    return ids;
  }

  /// Anchors that lead from the stack flown last to the one wanted, one contact at a time.
  [[nodiscard]] std::vector<int> changes() const {
    const std::vector<int> target = wanted();
    const auto [here, there] =
        std::mismatch(flown_.begin(), flown_.end(), target.begin(), target.end());
    std::vector<int> now = flown_;
    std::vector<int> anchors;
    while (now.size() > static_cast<std::size_t>(here - flown_.begin())) {
      now.pop_back();
      anchors.push_back(anchorOf(now));
    }
    anchors.insert(anchors.end(), there, target.end());
    return anchors;
  }

  /// The contact of a place: one that is there already, unless it is in use.
  [[nodiscard]] int idOf(const Eigen::Vector3d& p_WC) {
    const std::vector<int> used = wanted();
    if ((anchorPosition(plan_, anchorOf(used)) - p_WC).norm() < kSamePlace) return kLeftOut;
    for (int i = 0; i < plan_.contact_count; ++i) {
      const MissionContact& contact = plan_.contacts[static_cast<std::size_t>(i)];
      if ((contact.p_WC - p_WC).norm() < kSamePlace &&
          std::find(used.begin(), used.end(), contact.id) == used.end())
        return contact.id;
    }
    if (plan_.contact_count == kMaxContacts) throw tooMany("contacts", kMaxContacts);
    MissionContact& contact = plan_.contacts[static_cast<std::size_t>(plan_.contact_count++)];
    contact = {plan_.contact_count, p_WC};
    return contact.id;
  }

  void add(const Waypoint& waypoint) {
    if (plan_.waypoint_count == kMaxWaypoints) throw tooMany("waypoints", kMaxWaypoints);
    plan_.waypoints[static_cast<std::size_t>(plan_.waypoint_count++)] = waypoint;
  }

  [[nodiscard]] InputError tooMany(const char* what, int most) const {
    return InputError({.file = file_,
                       .problem = fmt::format("the plan has more {} than a mission holds", what),
                       .allowed = fmt::format("{}", most),
                       .remedy = "cut the path in two, or plan on a larger --resolution"});
  }

  Eigen::Vector3d reel_;
  MissionPlan& plan_;
  std::string file_;
  std::vector<int> stack_;  ///< As the events have it; kLeftOut for what missions do not have.
  std::vector<int> flown_;  ///< On the way to the last waypoint.
};

}  // namespace

void needReel(const VoxelMap& map) {
  if (map.reel) return;
  throw InputError({.key = "--output",
                    .problem = "a mission needs the place of the reel, and the map has none",
                    .remedy = "--reel x,y,z"},
                   ExitCode::kUsage);
}

Mission missionOf(const ContactPlan& plan, const std::vector<Waypoint>& orders, const VoxelMap& map,
                  const std::string& description, const std::filesystem::path& file) {
  needReel(map);
  TAUTLINE_CHECK(orders.size() == plan.states.size());
  Mission mission;
  mission.name = file.stem().stem().string();
  mission.description = description;
  mission.reel_position = *map.reel;
  mission.map =
      std::filesystem::relative(map.file, std::filesystem::absolute(file).parent_path()).string();
  mission.map_hash = hashText(map.hash);
  MissionWriter writer(mission, file.string());
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < plan.states.size(); ++i) {
    const TetherState& state = plan.states[i];
    // What happens at the waypoint before changes the anchor of this leg; what happens here that
    // of the next. The first waypoint is reached on a straight tether.
    if (i == 0) writer.flyTo(state.position, orders[i]);
    for (const ContactEvent& event : state.events) {
      if (i > 0 && event.vehicle != last) {
        Waypoint passing = orders[i];
        if (event.vehicle != state.position) passing.hold = 0.0;
        writer.flyTo(event.vehicle, passing);
        last = event.vehicle;
      }
      writer.apply(event);
    }
    if (i > 0 && last != state.position) writer.flyTo(state.position, orders[i]);
    last = state.position;
  }
  return mission;
}

}  // namespace tautline::planning
