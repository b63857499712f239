#pragma once

/// @file
/// Plans and risk tables as text, JSON and CSV. Not real-time safe: offline only.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "planning_offline/cli/workspace.h"
#include "planning_offline/planner/planner.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/risk/risk_report.h"
#include "planning_offline/tether/contact_plan.h"

namespace tautline::planning {

/// The dissertation's table: one row a state, one column an enabled element.
[[nodiscard]] std::string riskTableText(const RiskReport& report,
                                        const std::vector<RiskElement>& elements);
[[nodiscard]] std::string riskTableCsv(const RiskReport& report,
                                       const std::vector<RiskElement>& elements);
[[nodiscard]] nlohmann::json statesJson(const RiskReport& report,
                                        const std::vector<RiskElement>& elements);

/// The states of a path with the tether of the map's reel, which must be there.
[[nodiscard]] ContactPlan contactsOf(const RiskReport& report, const VoxelMap& map,
                                     const ContactOptions& options = {});

/// Length of the way along the states [m].
[[nodiscard]] double wayLength(const RiskReport& report);

/// One line about a result: status, risk, reward, utility, states.
[[nodiscard]] std::string summaryText(const std::string& planner, const PlanResult& result);

/// Everything about a result. Numbers that are not finite are null.
[[nodiscard]] nlohmann::json resultJson(const std::string& planner, const PlanResult& result,
                                        const PlanSpace& space);

}  // namespace tautline::planning
