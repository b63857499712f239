#include "common/mission/mission_file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "common/error.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"

namespace tautline {
namespace {

constexpr Range kCoordinate{-kMaxMissionCoordinate, kMaxMissionCoordinate};
constexpr Range kSpeed{0.0, kMaxMissionSpeed};
constexpr Range kHold{0.0, kMaxMissionHold};
constexpr Range kRisk{0.0, 1.0};
constexpr double kSamePlace =
    1e-3;  // [m]; a static tether segment shorter than this has no direction

std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::string row(const char* list, int i, const char* key = nullptr) {
  std::string text = std::string(list) + "[" + std::to_string(i) + "]";
  return key == nullptr ? text : text + "." + key;
}

[[noreturn]] void fail(std::string key, std::string problem, std::string allowed = {},
                       std::string remedy = {}) {
  throw InputError({.key = std::move(key),
                    .problem = std::move(problem),
                    .allowed = std::move(allowed),
                    .remedy = std::move(remedy)});
}

void checkNumber(double value, Range range, const std::string& key) {
  if (!range.contains(value)) fail(key, "is " + tomlText(value), rangeText(range));
}

void checkPoint(const Eigen::Vector3d& p, const std::string& key) {
  for (const double c : p) {
    if (!kCoordinate.contains(c))
      fail(key, "is " + tomlText(p), "[x, y, z], each " + rangeText(kCoordinate));
  }
}

void checkCount(std::size_t count, int min, int max, const char* list) {
  if (count < at(min) || count > at(max)) {
    fail(list, "has " + std::to_string(count) + " rows",
         std::to_string(min) + " to " + std::to_string(max));
  }
}

void readContacts(TomlTable& root, MissionPlan& plan) {
  std::vector<TomlTable> rows = root.tables("contacts");
  checkCount(rows.size(), 0, kMaxContacts, "contacts");
  for (TomlTable& table : rows) {
    MissionContact& contact = plan.contacts[at(plan.contact_count++)];
    table.require("id", contact.id, Range{1, 2147483647});
    table.require("position_m", contact.p_WC, kCoordinate);
    table.finish();
  }
}

void readWaypoints(TomlTable& root, MissionPlan& plan) {
  std::vector<TomlTable> rows = root.tables("waypoints");
  checkCount(rows.size(), 1, kMaxWaypoints, "waypoints");
  for (TomlTable& table : rows) {
    Waypoint& waypoint = plan.waypoints[at(plan.waypoint_count++)];
    table.require("position_m", waypoint.p_WD, kCoordinate);
    table.require("contact", waypoint.contact, Range{0, 2147483647});
    Eigen::Vector3d look_at = Eigen::Vector3d::Zero();
    if (table.read("look_at_m", look_at, kCoordinate)) waypoint.p_WL = look_at;
    table.read("speed_mps", waypoint.speed, kSpeed);
    table.read("hold_s", waypoint.hold, kHold);
    table.read("risk", waypoint.risk, kRisk);
    table.finish();
  }
}

void checkContactOrder(const MissionPlan& plan) {
  const std::vector<std::vector<int>> stacks = contactStacks(plan);
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const std::vector<int>& stack = stacks[at(i)];
    if (stack.empty()) continue;
    const int contact = stack.back();
    const int below = stack.size() > 1 ? stack[stack.size() - 2] : kReelContact;
    if ((anchorPosition(plan, contact) - anchorPosition(plan, below)).norm() < kSamePlace) {
      fail(row("waypoints", i, "contact"),
           "contact " + std::to_string(contact) + " is at the same place as the anchor below it (" +
               (below == kReelContact ? "the reel" : "contact " + std::to_string(below)) + ")",
           "contacts at least 1 mm apart", "use one id for one place");
    }
  }
}

Mission missionFrom(const TomlFile& file) {
  try {
    TomlTable root = file.root();
    Mission mission;
    int version = 0;
    root.require("version", version, Range{kMissionFileVersion, kMissionFileVersion});
    root.require("name", mission.name);
    root.read("description", mission.description);
    root.require("frame", mission.frame);
    root.read("reel_position_m", mission.reel_position, kCoordinate);
    root.read("map", mission.map);
    root.read("map_hash", mission.map_hash);
    readContacts(root, *mission.plan);
    readWaypoints(root, *mission.plan);
    root.finish();
    validateMission(mission);
    mission.plan->hash = missionHash(mission);
    return mission;
  } catch (const InputError& e) {
    throw file.locate(e);
  }
}

}  // namespace

Mission readMission(const std::filesystem::path& path) { return missionFrom(TomlFile::load(path)); }

Mission parseMission(std::string_view text, const std::string& name) {
  return missionFrom(TomlFile::parse(text, name));
}

void validateMission(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  if (mission.name.empty()) fail("name", "is empty", "a text in quotes");
  if (mission.frame != "W")
    fail("frame", "is " + tomlText(mission.frame), "\"W\" (origin at the reel outlet, y up)");
  checkPoint(mission.reel_position, "reel_position_m");
  checkCount(at(std::max(plan.contact_count, 0)), 0, kMaxContacts, "contacts");
  checkCount(at(std::max(plan.waypoint_count, 0)), 1, kMaxWaypoints, "waypoints");

  std::set<int> ids;
  for (int i = 0; i < plan.contact_count; ++i) {
    const MissionContact& contact = plan.contacts[at(i)];
    const std::string key = row("contacts", i, "id");
    if (contact.id <= kReelContact)
      fail(key, "is " + std::to_string(contact.id), "an integer, at least 1", "0 is the reel");
    if (!ids.insert(contact.id).second)
      fail(key, "is " + std::to_string(contact.id) + " again", "unique ids");
    checkPoint(contact.p_WC, row("contacts", i, "position_m"));
  }
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& waypoint = plan.waypoints[at(i)];
    checkPoint(waypoint.p_WD, row("waypoints", i, "position_m"));
    if (waypoint.p_WL) checkPoint(*waypoint.p_WL, row("waypoints", i, "look_at_m"));
    checkNumber(waypoint.speed, kSpeed, row("waypoints", i, "speed_mps"));
    checkNumber(waypoint.hold, kHold, row("waypoints", i, "hold_s"));
    checkNumber(waypoint.risk, kRisk, row("waypoints", i, "risk"));
    if (waypoint.contact != kReelContact && !ids.contains(waypoint.contact)) {
      std::string known = "0 (reel)";
      for (const int id : ids) known += ", " + std::to_string(id);
      fail(row("waypoints", i, "contact"),
           "there is no contact " + std::to_string(waypoint.contact), known, "add it to contacts");
    }
  }
  checkContactOrder(plan);
}

std::string canonicalText(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  std::string text = "version = " + tomlText(kMissionFileVersion) + "\n";
  text += "name = " + tomlText(mission.name) + "\n";
  if (!mission.description.empty()) text += "description = " + tomlText(mission.description) + "\n";
  text += "frame = " + tomlText(mission.frame) + "\n";
  text += "reel_position_m = " + tomlText(mission.reel_position) + "\n";
  if (!mission.map.empty()) text += "map = " + tomlText(mission.map) + "\n";
  if (!mission.map_hash.empty()) text += "map_hash = " + tomlText(mission.map_hash) + "\n";
  if (plan.contact_count > 0) {
    text += "\ncontacts = [\n";
    for (int i = 0; i < plan.contact_count; ++i) {
      const MissionContact& contact = plan.contacts[at(i)];
      text +=
          "  { id = " + tomlText(contact.id) + ", position_m = " + tomlText(contact.p_WC) + " },\n";
    }
    text += "]\n";
  }
  text += "\nwaypoints = [\n";
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& waypoint = plan.waypoints[at(i)];
    text +=
        "  { position_m = " + tomlText(waypoint.p_WD) + ", contact = " + tomlText(waypoint.contact);
    if (waypoint.p_WL) text += ", look_at_m = " + tomlText(*waypoint.p_WL);
    if (waypoint.speed != 0.0) text += ", speed_mps = " + tomlText(waypoint.speed);
    if (waypoint.hold != 0.0) text += ", hold_s = " + tomlText(waypoint.hold);
    if (waypoint.risk != 0.0) text += ", risk = " + tomlText(waypoint.risk);
    text += " },\n";
  }
  return text + "]\n";
}

std::uint64_t missionHash(const Mission& mission) { return fnv1a(canonicalText(mission)); }

std::uint64_t fnv1a(std::string_view bytes) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) {
    hash ^= static_cast<unsigned char>(byte);
    hash *= 0x100000001b3U;
  }
  return hash;
}

std::string hashText(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

void writeMission(Mission& mission, const std::filesystem::path& path) {
  const std::string text = canonicalText(mission);
  // Reading it back is the validation: what cannot be read is never written.
  mission.plan->hash = parseMission(text, path.string()).plan->hash;
  writeFileAtomically(path, text);
}

std::vector<std::vector<int>> contactStacks(const MissionPlan& plan) {
  std::vector<std::vector<int>> stacks;
  std::vector<int> stack;
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const int contact = plan.waypoints[at(i)].contact;
    const auto found = std::find(stack.begin(), stack.end(), contact);
    if (contact == kReelContact) {
      stack.clear();
    } else if (found == stack.end()) {
      stack.push_back(contact);
    } else {
      stack.erase(found + 1, stack.end());
    }
    stacks.push_back(stack);
  }
  return stacks;
}

Eigen::Vector3d anchorPosition(const MissionPlan& plan, int contact_id) {
  if (contact_id == kReelContact) return Eigen::Vector3d::Zero();
  const MissionContact* contact = plan.findContact(contact_id);
  TAUTLINE_CHECK(contact != nullptr);
  return contact->p_WC;
}

double staticLength(const MissionPlan& plan, const std::vector<int>& stack) {
  double length = 0.0;
  Eigen::Vector3d p_WA = Eigen::Vector3d::Zero();
  for (const int id : stack) {
    const Eigen::Vector3d p_WC = anchorPosition(plan, id);
    length += (p_WC - p_WA).norm();
    p_WA = p_WC;
  }
  return length;
}

}  // namespace tautline
