#include "common/mission/legacy_import.h"

#include <charconv>
#include <cmath>
#include <vector>

#include "common/error.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"

namespace tautline {
namespace {

constexpr double kVoxel = 0.33;      // [m], edge of the MATLAB planner's voxels in flown paths
constexpr double kVoxelReel = 0.01;  // where that planner puts the reel, on each axis [voxels]
constexpr std::string_view kSpaces = " \t\r\v\f,;";

struct Row {
  int line{0};
  std::vector<double> numbers;
};

[[noreturn]] void fail(const std::string& file, int line, std::string problem,
                       std::string allowed = {}) {
  throw InputError(
      {.file = file, .line = line, .problem = std::move(problem), .allowed = std::move(allowed)});
}

std::vector<double> parseNumbers(std::string_view text, const std::string& file, int line) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t begin = text.find_first_not_of(kSpaces);
    if (begin == std::string_view::npos) return numbers;
    text.remove_prefix(begin);
    std::string_view word = text.substr(0, text.find_first_of(kSpaces));
    text.remove_prefix(word.size());
    const std::string shown(word.substr(0, 40));
    if (word.front() == '+') word.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      fail(file, line, "'" + shown + "' is not a finite number", "numbers between spaces");
    }
    numbers.push_back(value);
  }
}

std::vector<Row> parseRows(std::string_view text, const std::string& file) {
  std::vector<Row> rows;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view content = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    content = content.substr(0, content.find_first_of("#%"));
    Row row{line, parseNumbers(content, file, line)};
    if (row.numbers.empty()) continue;
    const std::size_t count = row.numbers.size();
    if (rows.empty() ? count != 6 && count != 9 : count != rows.front().numbers.size()) {
      fail(file, line, "has " + std::to_string(count) + " numbers",
           rows.empty() ? "6 or 9 numbers a line"
                        : std::to_string(rows.front().numbers.size()) +
                              " numbers a line, as in the first row");
    }
    if (rows.size() == static_cast<std::size_t>(kMaxWaypoints)) {
      fail(file, line, "has too many rows", "at most " + std::to_string(kMaxWaypoints));
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) fail(file, 0, "has no rows", "6 or 9 numbers a line");
  return rows;
}

/// Three columns of a row, as they stand in the file.
Eigen::Vector3d triple(const Row& row, std::size_t first) {
  return {row.numbers[first], row.numbers[first + 1], row.numbers[first + 2]};
}

bool isReel(const Eigen::Vector3d& contact) {
  return contact.isZero(0.0) || contact == Eigen::Vector3d::Constant(kVoxelReel);
}

/// Id of the contact at this place, adding it at its first appearance.
int contactId(MissionPlan& plan, const Eigen::Vector3d& p_WC, const std::string& file, int line) {
  for (int i = 0; i < plan.contact_count; ++i) {
    const MissionContact& contact = plan.contacts[static_cast<std::size_t>(i)];
    if (contact.p_WC == p_WC) return contact.id;
  }
  if (plan.contact_count == kMaxContacts) {
    fail(file, line, "has one more distinct contact", "at most " + std::to_string(kMaxContacts));
  }
  MissionContact& added = plan.contacts[static_cast<std::size_t>(plan.contact_count++)];
  added = {plan.contact_count, p_WC};
  return added.id;
}

}  // namespace

LegacyAxes parseLegacyAxes(std::string_view text) {
  const auto wrong = [text] {
    return InputError(
        {.key = "--axes",
         .problem = "is '" + std::string(text) + "'",
         .allowed =
             "x, y and z in any order, each with an optional '-' before it, such as yzx or x-zy"},
        ExitCode::kUsage);
  };
  LegacyAxes axes;
  std::array<bool, 3> used{};
  std::size_t count = 0;
  double sign = 1.0;
  for (const char c : text) {
    if (c == '-' && sign > 0.0) {
      sign = -1.0;
      continue;
    }
    if (c < 'x' || c > 'z' || count == 3 || used[static_cast<std::size_t>(c - 'x')]) throw wrong();
    used[static_cast<std::size_t>(c - 'x')] = true;
    axes.column[count] = c - 'x';
    axes.sign[count] = sign;
    ++count;
    sign = 1.0;
  }
  if (count != 3 || sign < 0.0) throw wrong();
  return axes;
}

Mission parseLegacyMission(std::string_view text, const std::string& name,
                           const LegacyOptions& options) {
  const std::vector<Row> rows = parseRows(text, name);
  const bool has_poi = rows.front().numbers.size() == 9;
  const double scale = options.scale.value_or(has_poi ? 1.0 : kVoxel);
  const LegacyAxes axes = options.axes.value_or(parseLegacyAxes(has_poi ? "xyz" : "yzx"));
  const auto toWorld = [&](const Eigen::Vector3d& p) {
    Eigen::Vector3d p_W;
    for (std::size_t i = 0; i < 3; ++i) {
      p_W[static_cast<Eigen::Index>(i)] = axes.sign[i] * scale * p[axes.column[i]];
    }
    return p_W;
  };

  Mission mission;
  mission.name = options.name.empty() ? std::filesystem::path(name).stem().string() : options.name;
  mission.description = "imported from " + std::filesystem::path(name).filename().string();
  MissionPlan& plan = *mission.plan;
  for (const Row& row : rows) {
    Waypoint& waypoint = plan.waypoints[static_cast<std::size_t>(plan.waypoint_count++)];
    waypoint.p_WD = toWorld(triple(row, 0));
    if (has_poi && !triple(row, 3).isZero(0.0)) waypoint.p_WL = toWorld(triple(row, 3));
    const Eigen::Vector3d contact = triple(row, has_poi ? 6 : 3);
    waypoint.contact =
        isReel(contact) ? kReelContact : contactId(plan, toWorld(contact), name, row.line);
  }
  try {
    validateMission(mission);
  } catch (const InputError& e) {
    InputProblem problem = e.problem();
    problem.file = name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (problem.key.starts_with("waypoints[" + std::to_string(i) + "]"))
        problem.line = rows[i].line;
    }
    throw InputError(problem, e.code());
  }
  plan.hash = missionHash(mission);
  return mission;
}

Mission importLegacyMission(const std::filesystem::path& path, const LegacyOptions& options) {
  return parseLegacyMission(readTextFile(path), path.string(), options);
}

}  // namespace tautline
