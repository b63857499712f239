/// @file
/// `tautline-plan fields`: what the map says about every free cell, and the tether along the
/// least-risk path to it.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/plot/figure.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/layer_picture.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/picture/plan_picture.h"
#include "planning_offline/search/path_tethers.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

struct FieldsArguments {
  RiskArguments risk;
  std::string field{"all"};
  std::string start;
  bool json{false};
  std::string csv;
  LayerPicture picture;
};

struct NamedField {
  std::string name;
  std::string label;
  std::vector<double> values;
};

constexpr const char* kTetherLength = "tether_length";
constexpr const char* kContacts = "contacts";
constexpr std::array kFieldNames{"distance",    "width",       "visibility",
                                 "locale_risk", kTetherLength, kContacts};

/// What is shown, and a word on what is not.
struct ShownFields {
  std::vector<NamedField> fields;
  std::string note;
};

/// The free cell where least-risk paths start; nothing if neither map nor user has one. Unless the
/// start is needed, one of the scene that is not free is as good as none.
std::optional<CellIndex> pathStart(const FieldsArguments& arguments, const MapSpace& space,
                                   bool needed, std::string& note) {
  const VoxelMap& map = *space.map;
  std::optional<Eigen::Vector3d> start = map.start;
  if (!arguments.start.empty()) start = parsePoint(arguments.start, "--start");
  if (!start) return std::nullopt;
  const CellIndex cell = map.indexAt(*start);
  if (cell != kNoCell && space.lattice->free(cell)) return cell;
  const std::string problem =
      fmt::format("{} is not in the free space of the map {}", pointText(*start), map.name);
  if (arguments.start.empty() && !needed) {
    note = fmt::format("without {} and {}: start_m of the scene {}", kTetherLength, kContacts,
                       problem);
    return std::nullopt;
  }
  throw InputError({.key = arguments.start.empty() ? "start_m of the scene" : "--start",
                    .problem = problem,
                    .remedy = "another --start, or a smaller --clearance"},
                   arguments.start.empty() ? ExitCode::kConfig : ExitCode::kUsage);
}

/// Tether length and contacts along the least-risk path to every cell; infinite where none leads.
void addTetherFields(const RiskSpace& space, CellIndex start, int threads, const Progress& progress,
                     std::vector<NamedField>& out) {
  const Lattice& lattice = *space.space.lattice;
  const auto tree = leastRiskTree(lattice, *space.risk, start, threads, progress);
  const PathTethers tethers = tethersOfPaths(lattice, *space.risk, *tree, progress);
  out.push_back({kTetherLength, "tether on the least-risk path [m]", tethers.length});
  out.push_back({kContacts, "contacts on the least-risk path", {}});
  for (const std::int32_t contacts : tethers.contacts) {
    out.back().values.push_back(contacts < 0 ? std::numeric_limits<double>::infinity() : contacts);
  }
}

ShownFields shownFields(const FieldsArguments& arguments, const RiskSpace& space,
                        const Progress& progress) {
  const bool all = arguments.field == "all";
  if (!all &&
      std::find(kFieldNames.begin(), kFieldNames.end(), arguments.field) == kFieldNames.end()) {
    throw InputError({.key = "--field",
                      .problem = fmt::format("is '{}'", arguments.field),
                      .allowed = fmt::format("{}, all", fmt::join(kFieldNames, ", "))},
                     ExitCode::kUsage);
  }
  const MapFields& fields = space.risk->fields();
  const auto wide = [](const std::vector<float>& values) {
    return std::vector<double>(values.begin(), values.end());
  };
  ShownFields shown;
  std::vector<NamedField>& out = shown.fields;
  out = {{"distance", "distance to the closest obstacle [m]", wide(fields.distance)},
         {"width", "narrowest passage E_cd [m]", wide(fields.width)},
         {"visibility", "mean isovist length [m]", wide(fields.visibility)},
         {"locale_risk", "locale risk of a state", {}}};
  for (const double cost : space.risk->costs().locale)
    out.back().values.push_back(riskOfCost(cost));
  const bool tether = arguments.field == kTetherLength || arguments.field == kContacts;
  const std::optional<CellIndex> start = pathStart(arguments, space.space, tether, shown.note);
  if (start && space.risk->string() != nullptr && (all || tether)) {
    addTetherFields(space, *start, arguments.risk.map.threads, progress, out);
  } else if (tether) {
    throw InputError(
        {.key = "--field",
         .problem = fmt::format("'{}' needs where the tether and the paths begin", arguments.field),
         .allowed = "a map with reel and start, or --reel and --start"},
        ExitCode::kUsage);
  }
  std::erase_if(out, [&](const NamedField& f) { return !all && f.name != arguments.field; });
  return shown;
}

/// One layer of cells of each field.
void drawFields(const FieldsArguments& arguments, const VoxelMap& map,
                const std::vector<NamedField>& shown) {
  const int y = arguments.picture.layerOf(map);
  const int columns = shown.size() > 4 ? 3 : shown.size() > 1 ? 2 : 1;
  plot::Figure figure{.rows = shown.size() > 1 ? 2 : 1,
                      .columns = columns,
                      .width_px = columns == 3 ? 1650 : 1100,
                      .height_px = 900};
  for (const NamedField& field : shown) {
    figure.panels.push_back(
        fieldFigure(LayerPicture::titleOf(field.name, map, y), field.label, map, field.values, y)
            .panels.front());
  }
  plot::writeSvg(figure, arguments.picture.svg);
}

/// Every free cell; nothing where a field has no value.
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
    for (const NamedField& field : shown) {
      text += std::isfinite(field.values[i]) ? fmt::format(",{:.6g}", field.values[i]) : ",";
    }
    text += "\n";
  }
  writeFileAtomically(arguments.csv, text);
}

struct FieldRange {
  double least{std::numeric_limits<double>::infinity()};
  double mean{0.0};
  double most{-std::numeric_limits<double>::infinity()};
};

/// Over the free cells where the field has a value.
FieldRange rangeOf(const NamedField& field, const Lattice& lattice) {
  FieldRange range;
  std::size_t count = 0;
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (!lattice.free(static_cast<CellIndex>(i)) || !std::isfinite(field.values[i])) continue;
    range.least = std::min(range.least, field.values[i]);
    range.most = std::max(range.most, field.values[i]);
    range.mean += field.values[i];
    ++count;
  }
  range.mean /= static_cast<double>(count);
  return range;
}

ExitCode runFields(const FieldsArguments& arguments) {
  TerminalProgress terminal;
  const RiskSpace space = loadRiskSpace(arguments.risk, terminal.progress(), true);
  const VoxelMap& map = *space.space.map;
  const auto [shown, note] = shownFields(arguments, space, terminal.progress());
  terminal.clear();
  if (terminal.cancelled()) {
    fmt::print(stderr, "tautline-plan: stopped; the fields would be incomplete\n");
    return ExitCode::kFailed;
  }
  if (!note.empty() && !arguments.json) fmt::print(stderr, "tautline-plan: {}\n", note);
  if (!arguments.picture.svg.empty()) drawFields(arguments, map, shown);
  if (!arguments.csv.empty()) tabulateFields(arguments, space.space, shown);
  json out = {{"free", space.space.lattice->freeCount()},
              {"shape", {map.shape.nx, map.shape.ny, map.shape.nz}},
              {"origin_m", {map.origin.x(), map.origin.y(), map.origin.z()}},
              {"resolution_m", map.resolution}};
  if (!arguments.json) {
    fmt::print("{}: {} x {} x {} cells of {:g} m, {} free\n{:<13} {:>9} {:>9} {:>9}\n", map.name,
               map.shape.nx, map.shape.ny, map.shape.nz, map.resolution,
               space.space.lattice->freeCount(), "field", "least", "mean", "most");
  }
  for (const NamedField& field : shown) {
    const FieldRange range = rangeOf(field, *space.space.lattice);
    if (arguments.json) {
      out["fields"][field.name] = {{"min", range.least}, {"mean", range.mean}, {"max", range.most}};
    } else {
      fmt::print("{:<13} {:>9.4f} {:>9.4f} {:>9.4f}\n", field.name, range.least, range.mean,
                 range.most);
    }
  }
  if (arguments.json) fmt::print("{}\n", out.dump(2));
  return ExitCode::kOk;
}

}  // namespace

void addFieldsCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "fields",
      "Distance, passage width, visibility and locale risk over the map, and the tether along the "
      "least-risk paths");
  const auto arguments = std::make_shared<FieldsArguments>();
  arguments->risk.addTo(*verb);
  verb->add_option("--field", arguments->field,
                   fmt::format("{} or all", fmt::join(kFieldNames, ", ")))
      ->capture_default_str();
  verb->add_option("--start", arguments->start,
                   "Where the least-risk paths of tether_length and contacts start: x,y,z [m]; "
                   "default: the scene's start");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--csv", arguments->csv, "Write every free cell")->type_name("FILE");
  arguments->picture.addTo(*verb);
  verb->footer(
      "Example: tautline-plan fields --map config/scenes/two_contacts.scene.toml --svg fields.svg "
      "--height 1.2");
  verb->callback([arguments, &result] { result = runFields(*arguments); });
}

}  // namespace tautline::planning
