/// @file
/// `tautline-plan reach`, `fields` and `scen`: what is asked of a map alone.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/plot/figure.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/field/reach.h"
#include "planning_offline/picture/plan_picture.h"
#include "planning_offline/scenario/scenario.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

/// Height index of a layer: the given height, else the middle of the map.
int layerOf(const VoxelMap& map, double height) {
  if (!std::isfinite(height)) return map.shape.ny / 2;
  const int y = static_cast<int>(std::floor((height - map.origin.y()) / map.resolution));
  if (y >= 0 && y < map.shape.ny) return y;
  throw InputError({.key = "--height",
                    .problem = fmt::format("{:g} m is outside the map {}", height, map.name),
                    .allowed = fmt::format("{:g} to {:g}", map.origin.y(),
                                           map.origin.y() + map.resolution * map.shape.ny)},
                   ExitCode::kUsage);
}

double heightOf(const VoxelMap& map, int y) { return map.origin.y() + map.resolution * (y + 0.5); }

// ---- reach

struct ReachArguments {
  MapArguments map;
  ReachOptions options;
  bool json{false};
  std::string svg;
  double height{std::numeric_limits<double>::quiet_NaN()};
};

ExitCode runReach(const ReachArguments& arguments) {
  TerminalProgress terminal;
  const MapSpace space = loadMapSpace(arguments.map, terminal.progress());
  const VoxelMap& map = *space.map;
  if (!map.reel) {
    throw InputError({.key = "--reel",
                      .problem = "is missing and the map has none",
                      .allowed = "x,y,z in metres"},
                     ExitCode::kUsage);
  }
  ReachOptions options = arguments.options;
  options.threads = arguments.map.threads;
  const ReachMap reach =
      computeReach(map, space.lattice->freeCells(), *map.reel, options, terminal.progress());
  terminal.clear();
  if (terminal.cancelled()) {
    fmt::print(stderr, "tautline-plan: stopped; the counts would be incomplete\n");
    return ExitCode::kFailed;
  }
  if (!arguments.svg.empty()) {
    const int y = layerOf(map, arguments.height);
    std::vector<double> shown(map.shape.size());
    for (std::size_t i = 0; i < shown.size(); ++i)
      shown[i] = reach.straight[i] != 0 ? 1.0 : reach.with_contacts[i] != 0 ? 0.5 : 0.0;
    plot::writeSvg(fieldFigure(fmt::format("{} at y = {:.2f} m", map.name, heightOf(map, y)),
                               "reached: 1 straight, 0.5 with contacts, 0 not", map, shown, y),
                   arguments.svg);
  }
  const double free = static_cast<double>(reach.free);
  const double straight = static_cast<double>(reach.straight_count) / free;
  const double contacts = static_cast<double>(reach.with_contacts_count) / free;
  if (arguments.json) {
    fmt::print("{}\n", json{{"free", reach.free},
                            {"straight", reach.straight_count},
                            {"with_contacts", reach.with_contacts_count},
                            {"straight_fraction", straight},
                            {"with_contacts_fraction", contacts}}
                           .dump(2));
  } else {
    fmt::print(
        "free cells            {}\nstraight tether       {} ({:.1f} %)\nwith tether contacts  {} "
        "({:.1f} %)\n",
        reach.free, reach.straight_count, 100.0 * straight, reach.with_contacts_count,
        100.0 * contacts);
  }
  return ExitCode::kOk;
}

// ---- fields

struct FieldsArguments {
  RiskArguments risk;
  std::string field{"all"};
  bool json{false};
  std::string csv;
  std::string svg;
  double height{std::numeric_limits<double>::quiet_NaN()};
};

struct NamedField {
  std::string name;
  std::string label;
  std::vector<double> values;
};

std::vector<NamedField> namedFields(const RiskSpace& space) {
  const MapFields& fields = space.risk->fields();
  const auto wide = [](const std::vector<float>& values) {
    return std::vector<double>(values.begin(), values.end());
  };
  std::vector<NamedField> out{
      {"distance", "distance to the closest obstacle [m]", wide(fields.distance)},
      {"width", "narrowest passage E_cd [m]", wide(fields.width)},
      {"visibility", "mean isovist length [m]", wide(fields.visibility)},
      {"locale_risk", "locale risk of a state", {}}};
  for (const double cost : space.risk->costs().locale)
    out.back().values.push_back(riskOfCost(cost));
  return out;
}

/// One layer of cells of each field.
void drawFields(const FieldsArguments& arguments, const VoxelMap& map,
                const std::vector<NamedField>& shown) {
  const int y = layerOf(map, arguments.height);
  plot::Figure figure{.rows = shown.size() > 1 ? 2 : 1,
                      .columns = shown.size() > 1 ? 2 : 1,
                      .width_px = 1100,
                      .height_px = 900};
  for (const NamedField& field : shown) {
    figure.panels.push_back(
        fieldFigure(fmt::format("{} at y = {:.2f} m", field.name, heightOf(map, y)), field.label,
                    map, field.values, y)
            .panels.front());
  }
  plot::writeSvg(figure, arguments.svg);
}

/// Every free cell.
void tabulateFields(const FieldsArguments& arguments, const MapSpace& space,
                    const std::vector<NamedField>& shown) {
  const VoxelMap& map = *space.map;
  std::string text = "x_m,y_m,z_m";
  for (const NamedField& field : shown) text += "," + field.name;
  text += "\n";
  for (std::size_t i = 0; i < map.shape.size(); ++i) {
    if (!space.lattice->free(static_cast<CellIndex>(i))) continue;
    const Eigen::Vector3d p = map.centre(static_cast<CellIndex>(i));
    text += fmt::format("{:.6g},{:.6g},{:.6g}", p.x(), p.y(), p.z());
    for (const NamedField& field : shown) text += fmt::format(",{:.6g}", field.values[i]);
    text += "\n";
  }
  writeFileAtomically(arguments.csv, text);
}

ExitCode runFields(const FieldsArguments& arguments) {
  TerminalProgress terminal;
  const RiskSpace space = loadRiskSpace(arguments.risk, terminal.progress(), true);
  const VoxelMap& map = *space.space.map;
  terminal.clear();
  std::vector<NamedField> shown = namedFields(space);
  std::erase_if(shown, [&](const NamedField& f) {
    return arguments.field != "all" && f.name != arguments.field;
  });
  if (shown.empty()) {
    throw InputError({.key = "--field",
                      .problem = fmt::format("is '{}'", arguments.field),
                      .allowed = "distance, width, visibility, locale_risk, all"},
                     ExitCode::kUsage);
  }
  if (!arguments.svg.empty()) drawFields(arguments, map, shown);
  if (!arguments.csv.empty()) tabulateFields(arguments, space.space, shown);
  json out = {{"free", space.space.lattice->freeCount()},
              {"shape", {map.shape.nx, map.shape.ny, map.shape.nz}},
              {"origin_m", {map.origin.x(), map.origin.y(), map.origin.z()}},
              {"resolution_m", map.resolution}};
  if (!arguments.json) {
    fmt::print("{}: {} x {} x {} cells of {:g} m, {} free\n{:<12} {:>9} {:>9} {:>9}\n", map.name,
               map.shape.nx, map.shape.ny, map.shape.nz, map.resolution,
               space.space.lattice->freeCount(), "field", "least", "mean", "most");
  }
  for (const NamedField& field : shown) {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    double sum = 0.0;
    for (std::size_t i = 0; i < map.shape.size(); ++i) {
      if (!space.space.lattice->free(static_cast<CellIndex>(i))) continue;
      least = std::min(least, field.values[i]);
      most = std::max(most, field.values[i]);
      sum += field.values[i];
    }
    const double mean = sum / static_cast<double>(space.space.lattice->freeCount());
    if (arguments.json) {
      out["fields"][field.name] = {{"min", least}, {"mean", mean}, {"max", most}};
    } else {
      fmt::print("{:<12} {:>9.4f} {:>9.4f} {:>9.4f}\n", field.name, least, mean, most);
    }
  }
  if (arguments.json) fmt::print("{}\n", out.dump(2));
  return ExitCode::kOk;
}

}  // namespace

void addReachCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb =
      app.add_subcommand("reach", "Which part of free space a tether reaches from its reel");
  const auto arguments = std::make_shared<ReachArguments>();
  arguments->map.addTo(*verb);
  verb->add_option("--length-max-m", arguments->options.length_max,
                   "Tether on the reel; 0 = no limit")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--elevation-min-deg", arguments->options.elevation_min,
                   "Least elevation of a straight tether")
      ->check(CLI::Range(-90.0, 90.0));
  verb->add_option("--tether-clearance", arguments->options.tether_clearance,
                   "Distance that the straight tether keeps from obstacles [m]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--svg", arguments->svg, "Draw one layer of cells")->type_name("FILE");
  verb->add_option("--height", arguments->height,
                   "Height y of that layer [m]; default: the middle");
  verb->footer(
      "Example: tautline-plan reach --map config/scenes/two_contacts.scene.toml --clearance 0.3 "
      "--svg reach.svg");
  verb->callback([arguments, &result] { result = runReach(*arguments); });
}

void addFieldsCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "fields", "Distance, passage width, visibility and locale risk over the map");
  const auto arguments = std::make_shared<FieldsArguments>();
  arguments->risk.addTo(*verb);
  verb->add_option("--field", arguments->field, "distance, width, visibility, locale_risk or all")
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--csv", arguments->csv, "Write every free cell")->type_name("FILE");
  verb->add_option("--svg", arguments->svg, "Draw one layer of cells")->type_name("FILE");
  verb->add_option("--height", arguments->height,
                   "Height y of that layer [m]; default: the middle");
  verb->footer(
      "Example: tautline-plan fields --map config/scenes/two_contacts.scene.toml --svg fields.svg "
      "--height 1.2");
  verb->callback([arguments, &result] { result = runFields(*arguments); });
}

}  // namespace tautline::planning
