#include "app/experiments/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace tautline::experiments {
namespace {

using planning::PerElement;
using planning::RiskElement;
using planning::RiskParams;

constexpr int kMaxRounds = 20;
constexpr double kSame = 1e-4;  // relative change of a factor

constexpr double kMostRisk = 1.0;
constexpr double kMostPerUnit = 10.0;
constexpr double kMostPerMetre = 1.0;

/// The parameter that an element's risk is proportional to, and its largest value.
struct Knob {
  double* value;
  double most;
};

Knob knobOf(RiskParams& p, RiskElement element) {
  switch (element) {
    case RiskElement::kDistance:
      return {&p.distance.member.risk, kMostRisk};
    case RiskElement::kScale:
      return {&p.scale.member.risk, kMostRisk};
    case RiskElement::kVisibility:
      return {&p.visibility.member.risk, kMostRisk};
    case RiskElement::kDynamicThreat:
      return {&p.dynamic_threat.dwell, 3600.0};
    case RiskElement::kSingularity:
      return {&p.singularity.member.risk, kMostRisk};
    case RiskElement::kVerticality:
      return {&p.verticality.scale, kMostRisk};
    case RiskElement::kInclination:
      return {&p.lateral_inclination.scale, kMostRisk};
    case RiskElement::kTerrain:
      return {&p.terrain_stability.scale, kMostRisk};
    case RiskElement::kSurface:
      return {&p.surface.scale, kMostRisk};
    case RiskElement::kActionLength:
      return {&p.action_length.per_metre, kMostPerUnit};
    case RiskElement::kTurn:
      return {&p.turn.risk, kMostPerUnit};
    case RiskElement::kAccess:
      return {&p.access.per_unit, kMostPerUnit};
    case RiskElement::kTetherLength:
      return {&p.tether_length.per_metre, kMostPerMetre};
    case RiskElement::kContacts:
      return {&p.contacts.each, kMostRisk};
    case RiskElement::kSlippage:
      return {&p.slippage.per_mud, kMostPerUnit};
    case RiskElement::kBattery:
      return {&p.battery.member.risk, kMostRisk};
  }
  return {nullptr, 0.0};
}

}  // namespace

RiskParams scaled(RiskParams params, const PerElement& factors) {
  params.quantum = 0.0;
  for (std::size_t k = 0; k < planning::kRiskElements; ++k) {
    const Knob knob = knobOf(params, static_cast<RiskElement>(k));
    *knob.value = std::min(*knob.value * factors[k], knob.most);
  }
  return params;
}

std::vector<TruthPath> reassess(const std::vector<TruthPath>& paths, std::uint64_t seed,
                                const RiskParams& params) {
  std::map<int, planning::RiskSpace> spaces;
  std::vector<TruthPath> again = paths;
  for (TruthPath& path : again) {
    if (!spaces.contains(path.map)) spaces.emplace(path.map, truthSpace(path.map, seed, params));
    path.prediction = predict(*spaces.at(path.map).risk, path.points);
  }
  return again;
}

CalibratedRisk calibrate(const std::vector<TruthPath>& seen, std::uint64_t seed,
                         const RiskParams& params) {
  CalibratedRisk result{.params = params, .factors = {}};
  result.factors.fill(1.0);
  const std::vector<TruthPath> original = reassess(seen, seed, scaled(params, result.factors));
  const std::vector<RiskElement> elements = elementsOf(original);
  double change = 1.0;
  for (; result.rounds < kMaxRounds && change > kSame; ++result.rounds) {
    // Costs per unit of each factor, as the model has them at the present factors.
    std::vector<TruthPath> unit = reassess(seen, seed, scaled(params, result.factors));
    for (std::size_t i = 0; i < unit.size(); ++i) {
      for (std::size_t k = 0; k < planning::kRiskElements; ++k) {
        double& cost = unit[i].prediction.element_cost[k];
        cost = result.factors[k] > 0.0 ? cost / result.factors[k]
                                       : original[i].prediction.element_cost[k];
      }
    }
    const Eigen::VectorXd fitted = fitFactors(outcomesOf(unit, elements));
    change = 0.0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      double& factor = result.factors[static_cast<std::size_t>(elements[i])];
      const double next = fitted[static_cast<Eigen::Index>(i)];
      change = std::max(change, std::abs(next - factor) / std::max(factor, kSame));
      factor = next;
    }
  }
  result.params = scaled(params, result.factors);
  return result;
}

}  // namespace tautline::experiments
