#pragma once

/// @file
/// What all verbs of `tautline-plan` begin with: the options about map, vehicle and risk, and the
/// map, lattice and risk model made of them. Not real-time safe: offline only.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <Eigen/Core>

#include "common/error.h"
#include "common/fields.h"
#include "planning_offline/field/map_fields.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/planner/planner.h"
#include "planning_offline/progress.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// "x,y,z" in metres. Throws InputError (usage) that names the option.
[[nodiscard]] Eigen::Vector3d parsePoint(const std::string& text, const char* option);

/// "(x, y, z)" for messages.
[[nodiscard]] std::string pointText(const Eigen::Vector3d& p);

/// An error of usage about an option.
[[nodiscard]] InputError usage(const char* option, std::string problem, std::string allowed = {},
                               std::string remedy = {});

/// Throws InputError (usage) that names the option unless its value is finite: CLI::Range lets NaN
/// pass.
void needFinite(const char* option, double value);

/// Largest length that an option takes [m].
inline constexpr double kFarthestMetres = 1e6;

/// An option whose value is one of `names`; its default is the value that is there.
template <class Enum, std::size_t N>
void addChoice(CLI::App& verb, const char* option, Enum& value,
               const std::array<EnumName<Enum>, N>& names, const char* help) {
  std::string allowed;
  for (const auto& entry : names) allowed += (allowed.empty() ? "" : "|") + std::string(entry.name);
  const auto set = [&value, &names, option, allowed](const std::string& text) {
    for (const auto& entry : names) {
      if (text != entry.name) continue;
      value = entry.value;
      return;
    }
    throw usage(option, "is '" + text + "'", allowed);
  };
  verb.add_option_function<std::string>(option, set, help)
      ->type_name(allowed)
      ->default_str(nameOf(value, names));
}

/// About the map and where in it the vehicle may be.
struct MapArguments {
  std::string map;
  double resolution{0.0};
  std::string crop;
  std::string slice;
  double clearance{0.0};
  bool unknown_is_free{false};
  Connectivity connectivity{Connectivity::kVertices};
  std::string reel;
  std::vector<std::string> no_contact;
  int memory_mb{4096};
  int threads{0};

  void addTo(CLI::App& verb);
};

/// Map, free space and lattice.
struct MapSpace {
  std::shared_ptr<const VoxelMap> map;
  std::unique_ptr<Lattice> lattice;
};
[[nodiscard]] MapSpace loadMapSpace(const MapArguments& arguments, const Progress& progress);

/// A map with its risk.
struct RiskArguments {
  MapArguments map;
  std::string params;

  void addTo(CLI::App& verb);
};
struct RiskSpace {
  MapSpace space;
  std::unique_ptr<RiskModel> risk;
};
/// The risk of a map that is there. Unknown space is an obstacle of the fields.
[[nodiscard]] RiskSpace makeRiskSpace(MapSpace space, const RiskParams& params,
                                      const Progress& progress);
/// `all_fields`: every field and without limits, not only what the risk elements read.
[[nodiscard]] RiskSpace loadRiskSpace(const RiskArguments& arguments, const Progress& progress,
                                      bool all_fields = false);

/// Where to plan from and to, and with what effort.
struct PlanArguments {
  RiskArguments risk;
  std::string start;
  std::string goal;
  std::string rewards;
  Objective objective{Objective::kRatio};
  PlanOptions options;
  bool straight_tether{false};

  void addTo(CLI::App& verb);
};
struct PlanSpace {
  RiskSpace risk_space;
  PlanProblem problem;
  PlanOptions options;
  std::vector<Reward> rewards;  ///< Planned with, M [m].
  double clearance{0.0};        ///< [m]
};
[[nodiscard]] PlanSpace loadPlanSpace(const PlanArguments& arguments, const Progress& progress);

}  // namespace tautline::planning
