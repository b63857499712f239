#include "app/cli/mission_svg_command.h"

#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "common/mission/mission_check.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "common/plot/views.h"

namespace tautline::cli {
namespace {

using plot::Colour;
using plot::Drawing;
using plot::SpaceCurve;
using plot::Style;
using plot::Symbol;

struct Options {
  std::string mission;
  std::string scene;
  std::string picture;
};

const Eigen::Vector3d kBreak = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

// Straight tether from the reel along the contacts to each waypoint, one after the other.
SpaceCurve tetherLines(const MissionPlan& plan) {
  SpaceCurve out{.name = "tether at a waypoint",
                 .points = {},
                 .style = Style::kLine,
                 .colour = Colour::kSky,
                 .width = 0.6};
  const auto stacks = contactStacks(plan);
  for (std::size_t i = 0; i < stacks.size(); ++i) {
    out.points.push_back(Eigen::Vector3d::Zero());
    for (const int contact : stacks[i]) out.points.push_back(anchorPosition(plan, contact));
    out.points.push_back(plan.waypoints[i].p_WD);
    out.points.push_back(kBreak);
  }
  return out;
}

Drawing missionDrawing(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  Drawing drawing;
  drawing.title = mission.name;
  SpaceCurve path{
      .name = "path", .points = {}, .style = Style::kLine, .colour = Colour::kBlue, .width = 2.2};
  SpaceCurve waypoints{.name = "waypoint",
                       .points = {},
                       .style = Style::kPoints,
                       .colour = Colour::kBlue,
                       .width = 1.2};
  SpaceCurve looks{.name = "looks at",
                   .points = {},
                   .style = Style::kDotted,
                   .colour = Colour::kPurple,
                   .width = 1.0};
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& w = plan.waypoints[static_cast<std::size_t>(i)];
    path.points.push_back(w.p_WD);
    if (w.p_WL) looks.points.insert(looks.points.end(), {w.p_WD, *w.p_WL, kBreak});
  }
  waypoints.points = path.points;
  drawing.curves = {tetherLines(plan), path, waypoints};
  if (!looks.points.empty()) drawing.curves.push_back(looks);

  drawing.markers.push_back(
      {.at = Eigen::Vector3d::Zero(), .label = "reel", .symbol = Symbol::kSquare, .size = 1.3});
  for (int i = 0; i < plan.contact_count; ++i) {
    const MissionContact& c = plan.contacts[static_cast<std::size_t>(i)];
    drawing.markers.push_back({.at = c.p_WC,
                               .label = "contact " + std::to_string(c.id),
                               .symbol = Symbol::kDiamond,
                               .colour = Colour::kVermilion,
                               .size = 1.2});
  }
  drawing.markers.push_back({.at = path.points.front(),
                             .symbol = Symbol::kTriangle,
                             .colour = Colour::kGreen,
                             .size = 1.5,
                             .name = "first"});
  drawing.markers.push_back({.at = path.points.back(),
                             .symbol = Symbol::kCross,
                             .colour = Colour::kPurple,
                             .size = 1.4,
                             .name = "last"});
  return drawing;
}

ExitCode run(const Options& options) {
  const Mission mission = readMission(options.mission);
  Drawing drawing;
  if (const auto scene = findScene(mission, options.mission, options.scene)) {
    addScene(drawing, sceneInWorld(*scene));
  }
  Drawing plan = missionDrawing(mission);
  drawing.title = plan.title;
  drawing.curves.insert(drawing.curves.end(), plan.curves.begin(), plan.curves.end());
  drawing.markers = plan.markers;
  plot::writeSvg(viewsFigure(drawing), options.picture);
  std::printf("%s\n", options.picture.c_str());
  return ExitCode::kOk;
}

}  // namespace

void addMissionSvgCommand(CLI::App& mission, ExitCode& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      mission.add_subcommand("svg", "Draw a mission from above, from the front and from the side");
  verb->add_option("file", options->mission, "Mission file")->required()->type_name("FILE");
  verb->add_option("--scene", options->scene,
                   "Scene whose obstacles are drawn, instead of the mission's own map")
      ->type_name("SCENE");
  verb->add_option("-o,--output", options->picture, "Picture to write")
      ->required()
      ->type_name("OUT.svg");
  verb->footer(
      "Example: tautline mission svg config/missions/one_contact.mission.toml -o one_contact.svg");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
