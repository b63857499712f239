#include "planning_offline/risk/element_laws.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_offline/risk/risk_report.h"

namespace tautline::planning {
namespace {

constexpr double kSameDirection = 1e-6;   // between unit vectors; far above rounding
constexpr double kGranular = 1.0 + 1e-6;  // fields are stored as float

/// Rounded to the nearest multiple of the quantum and capped. A half goes up, also where rounding
/// errors put it a little below: otherwise equal steps could have different risks.
double settled(const RiskParams& params, double raw) {
  if (params.quantum > 0.0) {
    constexpr double kTie = 1e-9;
    raw = params.quantum * std::floor(raw / params.quantum + 0.5 + kTie);
  }
  return std::min(raw, params.cap);
}

/// As settled(), but certain failure stays certain.
double settledOrCertain(const RiskParams& params, double raw) {
  return raw >= 1.0 ? 1.0 : settled(params, raw);
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

}  // namespace

double distanceRisk(const RiskParams& params, double distance) {
  return settledOrCertain(params, params.distance.member.of(distance - params.distance.tolerance));
}

double scaleRisk(const RiskParams& params, double width) {
  const double scale = width / params.scale.agent_dimension;
  if (params.scale.forbid_granular && scale <= kGranular) return 1.0;
  return settledOrCertain(params, params.scale.member.of(scale));
}

double visibilityRisk(const RiskParams& params, double visibility) {
  return settledOrCertain(params, params.visibility.member.of(visibility));
}

double threatRisk(const RiskParams& params, double per_second) {
  return settledOrCertain(params,
                          -std::expm1(params.dynamic_threat.dwell * std::log1p(-per_second)));
}

double singularityRisk(const RiskParams& params, double elevation) {
  return settledOrCertain(params, params.singularity.member.of(degrees(elevation)));
}

double layerRisk(const RiskParams& params, const LayerParams& layer, double value) {
  return settledOrCertain(params, layer.scale * value);
}

double actionLengthRisk(const RiskParams& params, double length) {
  return settled(params, params.action_length.per_metre * length);
}

double turnRisk(const RiskParams& params, const Eigen::Vector3d& previous,
                const Eigen::Vector3d& action) {
  const TurnParams& turn = params.turn;
  const double lengths = previous.norm() * action.norm();
  if (lengths == 0.0) return 0.0;
  const double change = (action - previous).norm();
  switch (turn.law) {
    case TurnLaw::kConstant: {
      const bool turned = (action.normalized() - previous.normalized()).norm() > kSameDirection;
      return settled(params, turned ? turn.risk : 0.0);
    }
    case TurnLaw::kLinear:
      return settled(params, turn.risk * change);
    case TurnLaw::kQuadratic:
      return settled(params, turn.risk * change * change);
    case TurnLaw::kThreshold: {
      const bool gentle = previous.dot(action) / lengths > turn.gentle_cosine;
      return settled(params, turn.risk * change * (gentle ? 1.0 : turn.sharp_factor));
    }
  }
  return 0.0;
}

double accessRisk(const RiskParams& params, double lost) {
  return settled(params, params.access.per_unit * lost);
}

double tetherLengthRisk(const RiskParams& params, double length) {
  if (!params.tether_limits.allowsLength(length)) return 1.0;
  return settled(params, params.tether_length.per_metre * length);
}

double contactsRisk(const RiskParams& params, int contacts) {
  if (!params.tether_limits.allowsContacts(contacts)) return 1.0;
  return settled(params, params.contacts.each * contacts);
}

double slippageRisk(const RiskParams& params, double mud, double layer) {
  return settled(params, params.slippage.per_mud * mud * layer);
}

double batteryRisk(const RiskParams& params, double used) {
  return settledOrCertain(params, params.battery.member.of(used));
}

double mudGathered(const RiskParams& params, double left, double reached, double step) {
  return params.mode == RiskMode::kPerState
             ? left
             : (left + reached) * (step / (2.0 * params.reference_step));
}

double energyUsed(const RiskParams& params, const Eigen::Vector3d& move) {
  const double climb = std::max(0.0, move.y());
  return (move.norm() + params.battery.climb_factor * climb) / params.battery.range;
}

double actionLengthCost(const RiskParams& params, double length) {
  if (params.mode == RiskMode::kPerState) return costOfRisk(actionLengthRisk(params, length));
  return costOfRisk(actionLengthRisk(params, params.reference_step)) / params.reference_step *
         length;
}

double turnCost(const RiskParams& params, const Eigen::Vector3d& previous,
                const Eigen::Vector3d& action) {
  return costOfRisk(params.mode == RiskMode::kPerState
                        ? turnRisk(params, previous, action)
                        : turnRisk(params, previous.normalized(), action.normalized()));
}

double accessCost(const RiskParams& params, double lost) {
  if (params.mode == RiskMode::kPerState) return costOfRisk(accessRisk(params, lost));
  return std::min(params.access.per_unit * lost, costOfRisk(params.cap));
}

}  // namespace tautline::planning
