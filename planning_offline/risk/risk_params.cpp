#include "planning_offline/risk/risk_params.h"

#include <string>

#include "common/error.h"

namespace tautline::planning {
namespace {

void requireOrder(bool ordered, const char* key, const std::string& allowed) {
  if (!ordered) {
    throw InputError({.key = key,
                      .problem = "the values of full and no membership are in the wrong order",
                      .allowed = allowed,
                      .remedy = "exchange or move them"});
  }
}

}  // namespace

void DistanceParams::validate() const {
  requireOrder(member.none > member.full, "none_m", "above full_m");
}

void ScaleParams::validate() const {
  requireOrder(member.none > member.full, "none", "above full");
}

void VisibilityParams::validate() const {
  requireOrder(member.none > member.full, "none_m", "above full_m");
}

void SingularityParams::validate() const {
  requireOrder(member.none < member.full, "none_deg", "below full_deg");
}

void BatteryParams::validate() const {
  requireOrder(member.none < member.full, "none", "below full");
}

void RiskParams::validate() const {
  if (mode == RiskMode::kRate && quantum > 0.0) {
    throw InputError(
        {.key = "quantum",
         .problem = "rate mode takes risks per way, there are no risks of states to round",
         .allowed = "0 in rate mode",
         .remedy = "set quantum = 0 or mode = \"per_state\""});
  }
}

bool isOn(const RiskParams& params, RiskElement element) noexcept {
  switch (element) {
    case RiskElement::kDistance:
      return params.distance.member.risk > 0.0;
    case RiskElement::kScale:
      return params.scale.member.risk > 0.0;
    case RiskElement::kVisibility:
      return params.visibility.member.risk > 0.0;
    case RiskElement::kDynamicThreat:
      return params.dynamic_threat.dwell > 0.0;
    case RiskElement::kSingularity:
      return params.singularity.member.risk > 0.0;
    case RiskElement::kVerticality:
      return params.verticality.scale > 0.0;
    case RiskElement::kInclination:
      return params.lateral_inclination.scale > 0.0;
    case RiskElement::kTerrain:
      return params.terrain_stability.scale > 0.0;
    case RiskElement::kSurface:
      return params.surface.scale > 0.0;
    case RiskElement::kActionLength:
      return params.action_length.per_metre > 0.0;
    case RiskElement::kTurn:
      return params.turn.risk > 0.0;
    case RiskElement::kAccess:
      return params.access.per_unit > 0.0;
    case RiskElement::kTetherLength:
      return params.tether_length.per_metre > 0.0;
    case RiskElement::kContacts:
      return params.contacts.each > 0.0;
    case RiskElement::kSlippage:
      return params.slippage.per_mud > 0.0;
    case RiskElement::kBattery:
      return params.battery.member.risk > 0.0;
  }
  return false;
}

}  // namespace tautline::planning
