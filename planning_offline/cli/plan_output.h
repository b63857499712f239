#pragma once

/// @file
/// Plans and risk tables as text, JSON, CSV and mission files. Not real-time safe: offline only.

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/mission/mission_file.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/planner/planner.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/risk/risk_report.h"

namespace tautline::planning {

/// The dissertation's table: one row a state, one column an enabled element.
[[nodiscard]] std::string riskTableText(const RiskReport& report,
                                        const std::vector<RiskElement>& elements);
[[nodiscard]] std::string riskTableCsv(const RiskReport& report,
                                       const std::vector<RiskElement>& elements);
[[nodiscard]] nlohmann::json statesJson(const RiskReport& report,
                                        const std::vector<RiskElement>& elements);

/// Length of the way along the states [m].
[[nodiscard]] double wayLength(const RiskReport& report);

/// One line about a result: status, risk, reward, utility, states.
[[nodiscard]] std::string summaryText(const std::string& planner, const PlanResult& result);

/// Everything about a result. Numbers that are not finite are null.
[[nodiscard]] nlohmann::json resultJson(const std::string& planner, const PlanResult& result,
                                        const PlanSpace& space);

/// The path as a mission (docs/mission_files.md): shifted to the reel, with the tether contacts of
/// every state and its state risk; its map is given relative to the folder of `file`. Throws
/// InputError: no reel, or more waypoints or contacts than a mission holds.
[[nodiscard]] Mission missionOf(const PlanResult& result, const VoxelMap& map,
                                const std::string& description, const std::filesystem::path& file);

/// Throws InputError (usage) if the map has no reel: asked before anything is planned for a
/// mission.
void needReel(const VoxelMap& map);

}  // namespace tautline::planning
