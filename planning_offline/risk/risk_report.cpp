#include "planning_offline/risk/risk_report.h"

#include <string>

#include "common/error.h"
#include "planning_offline/risk/risk_params.h"

namespace tautline::planning {

TableRisk riskOfTable(const std::vector<std::vector<double>>& elements) {
  TableRisk result;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    double cost = 0.0;
    for (std::size_t k = 0; k < elements[i].size(); ++k) {
      const double r = elements[i][k];
      if (!kProbability.contains(r)) {
        throw InputError({.key = "elements[" + std::to_string(i) + "][" + std::to_string(k) + "]",
                          .problem = "is " + std::to_string(r),
                          .allowed = "a number, 0 to 1"});
      }
      cost += costOfRisk(r);
    }
    result.state_risk.push_back(riskOfCost(cost));
    result.cost += cost;
  }
  result.risk = riskOfCost(result.cost);
  return result;
}

}  // namespace tautline::planning
