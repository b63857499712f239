/// @file
/// `tautline-plan reach`: which part of free space a tether reaches from its reel.

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/plot/figure.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/layer_picture.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/field/reach.h"
#include "planning_offline/picture/plan_picture.h"
#include "planning_offline/planner/tether_reach.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

struct ReachArguments {
  MapArguments map;
  TetherLimits limits;
  double tether_clearance{0.0};
  bool json{false};
  LayerPicture picture;

  [[nodiscard]] bool lengthLimited() const noexcept { return limits.length_max > 0.0; }
  [[nodiscard]] bool elevationLimited() const noexcept { return limits.elevation_min > -90.0; }
  /// Asked for what only the taut string knows.
  [[nodiscard]] bool limited() const noexcept {
    return lengthLimited() || elevationLimited() || limits.contacts_max >= 0;
  }
};

/// One line of the answer: cells by a rule, and how many it can be at most where that is not known
/// exactly.
struct ReachFigure {
  std::string key;
  std::string text;
  std::size_t cells{0};
  std::optional<std::size_t> at_most;
};

std::vector<ReachFigure> reachFigures(const ReachArguments& arguments, const ReachMap& reach,
                                      const std::optional<TetherReach>& limited) {
  const TetherLimits& limits = arguments.limits;
  const std::string length = fmt::format("  within {:g} m", limits.length_max);
  const std::string elevation = fmt::format("  at {:g} deg or more", limits.elevation_min);
  const bool both = arguments.lengthLimited() && arguments.elevationLimited();
  std::vector<ReachFigure> out{{"straight", "straight tether", reach.straight_count, {}}};
  const auto add = [&out](bool asked, ReachFigure figure) {
    if (asked) out.push_back(std::move(figure));
  };
  add(arguments.lengthLimited(),
      {"straight_within_length", length, reach.straight_within_length, {}});
  add(arguments.elevationLimited(),
      {"straight_within_elevation", elevation, reach.straight_within_elevation, {}});
  add(both, {"straight_within_limits", "  both", reach.straight_within_limits, {}});
  out.push_back({"with_contacts", "with tether contacts", reach.with_contacts_count, {}});
  if (!limited) return out;
  add(arguments.lengthLimited(), {"with_contacts_within_length", length,
                                  limited->within_length.reached, limited->within_length.at_most});
  add(arguments.elevationLimited(),
      {"with_contacts_within_elevation", elevation, limited->within_elevation, {}});
  add(both, {"with_contacts_within_limits", "  both", limited->within_limits.reached,
             limited->within_limits.at_most});
  return out;
}

void printReachTable(std::size_t free, const std::vector<ReachFigure>& figures,
                     const std::vector<ReachBounds>& by_contacts) {
  const auto row = [free](const std::string& text, std::size_t cells,
                          std::optional<std::size_t> at_most) {
    const auto share = [free](std::size_t n) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(free);
    };
    fmt::print("{:<22} {:>9} {:>7.1f} %", text, cells, share(cells));
    if (at_most) fmt::print("   at most {:>9} {:>7.1f} %", *at_most, share(*at_most));
    fmt::print("\n");
  };
  row("free cells", free, {});
  for (const ReachFigure& figure : figures) row(figure.text, figure.cells, figure.at_most);
  for (std::size_t k = 0; k < by_contacts.size(); ++k) {
    row(fmt::format("  {} contact{}", k == 0 ? "no" : fmt::format("at most {}", k),
                    k == 1 ? "" : "s"),
        by_contacts[k].reached, by_contacts[k].at_most);
  }
}

json reachJson(const ReachArguments& arguments, const VoxelMap& map, const ReachMap& reach,
               const std::vector<ReachFigure>& figures,
               const std::vector<ReachBounds>& by_contacts) {
  const auto free = static_cast<double>(reach.free);
  json out = {{"free", reach.free}};
  const auto put = [&out, free](const std::string& key, std::size_t cells) {
    out[key] = cells;
    out[key + "_fraction"] = static_cast<double>(cells) / free;
  };
  for (const ReachFigure& figure : figures) {
    put(figure.key, figure.cells);
    if (figure.at_most) put(figure.key + "_bound", *figure.at_most);
  }
  for (const ReachBounds& bounds : by_contacts) {
    out["with_contacts_at_most"].push_back(bounds.reached);
    out["with_contacts_at_most_fraction"].push_back(static_cast<double>(bounds.reached) / free);
    out["with_contacts_at_most_bound"].push_back(bounds.at_most);
  }
  if (reach.take_off != kNoCell) {
    const Eigen::Vector3d p = map.centre(reach.take_off);
    out["take_off_m"] = {p.x(), p.y(), p.z()};
  }
  if (arguments.lengthLimited()) out["length_max_m"] = arguments.limits.length_max;
  if (arguments.limits.contacts_max >= 0) out["contacts_max"] = arguments.limits.contacts_max;
  if (arguments.elevationLimited()) out["elevation_min_deg"] = arguments.limits.elevation_min;
  return out;
}

/// One layer of cells: by the contacts of the way that needs fewest, if they are known.
void drawReach(const ReachArguments& arguments, const VoxelMap& map, const ReachMap& reach,
               const std::optional<TetherReach>& limited) {
  const int y = arguments.picture.layerOf(map);
  std::vector<double> shown(map.shape.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (limited) {
      shown[i] =
          limited->contacts[i] < 0 ? std::numeric_limits<double>::infinity() : limited->contacts[i];
    } else {
      shown[i] = reach.straight[i] != 0 ? 1.0 : reach.with_contacts[i] != 0 ? 0.5 : 0.0;
    }
  }
  plot::writeSvg(fieldFigure(LayerPicture::titleOf(map.name, map, y),
                             limited ? "contacts on the way; red: not reached"
                                     : "reached: 1 straight, 0.5 with contacts, 0 not",
                             map, shown, y),
                 arguments.picture.svg);
}

ExitCode runReach(const ReachArguments& arguments) {
  needFinite("--length-max-m", arguments.limits.length_max);
  needFinite("--elevation-min-deg", arguments.limits.elevation_min);
  needFinite("--tether-clearance", arguments.tether_clearance);
  TerminalProgress terminal;
  const MapSpace space = loadMapSpace(arguments.map, terminal.progress());
  const VoxelMap& map = *space.map;
  if (!map.reel) {
    throw InputError({.key = "--reel",
                      .problem = "is missing and the map has none",
                      .allowed = "x,y,z in metres"},
                     ExitCode::kUsage);
  }
  const ReachOptions options{.limits = arguments.limits,
                             .tether_clearance = arguments.tether_clearance,
                             .threads = arguments.map.threads};
  const ReachMap reach =
      computeReach(map, space.lattice->freeCells(), *map.reel, options, terminal.progress());
  std::optional<TetherReach> limited;
  if (arguments.limited() && !terminal.cancelled()) {
    limited = tetherReach(space.map, *space.lattice, reach, arguments.limits, terminal.progress());
  }
  terminal.clear();
  if (terminal.cancelled()) {
    fmt::print(stderr, "tautline-plan: stopped; the counts would be incomplete\n");
    return ExitCode::kFailed;
  }
  if (!arguments.picture.svg.empty()) drawReach(arguments, map, reach, limited);
  const std::vector<ReachFigure> figures = reachFigures(arguments, reach, limited);
  const std::vector<ReachBounds> by_contacts =
      limited ? limited->with_at_most : std::vector<ReachBounds>{};
  if (arguments.json) {
    fmt::print("{}\n", reachJson(arguments, map, reach, figures, by_contacts).dump(2));
  } else {
    printReachTable(reach.free, figures, by_contacts);
  }
  return ExitCode::kOk;
}

}  // namespace

void addReachCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb =
      app.add_subcommand("reach", "Which part of free space a tether reaches from its reel");
  const auto arguments = std::make_shared<ReachArguments>();
  arguments->map.addTo(*verb);
  verb->add_option("--length-max-m", arguments->limits.length_max,
                   "Also count what is within this tether length; 0 = not")
      ->check(CLI::Range(0.0, kFarthestMetres));
  verb->add_option("--elevation-min-deg", arguments->limits.elevation_min,
                   "Also count what is at least this high, seen from the active anchor")
      ->check(CLI::Range(-90.0, 90.0));
  verb->add_option("--contacts-max", arguments->limits.contacts_max,
                   "Also count what is reached with at most 0, 1, ... this many contacts")
      ->check(CLI::Range(0, 1000));
  verb->add_option("--tether-clearance", arguments->tether_clearance,
                   "Distance that the straight tether keeps from obstacles [m]")
      ->check(CLI::Range(0.0, kFarthestMetres))
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  arguments->picture.addTo(*verb);
  verb->footer(
      "Example: tautline-plan reach --map config/scenes/two_contacts.scene.toml --clearance 0.3 "
      "--length-max-m 4 --contacts-max 3 --svg reach.svg");
  verb->callback([arguments, &result] { result = runReach(*arguments); });
}

}  // namespace tautline::planning
