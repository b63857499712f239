#pragma once

/// @file
/// Parameters of the risk elements: every number that a path's risk depends on besides the map
/// (docs/risk.md has the formula of each element). One TOML file, read with `--params`; missing
/// keys keep the defaults below. Risks are probabilities of not finishing a state, in [0, 1]. Not
/// real-time safe: offline only.

#include <array>
#include <cstdint>

#include "common/fields.h"
#include "planning_offline/field/tether_limits.h"
#include "planning_offline/risk/risk_element.h"

namespace tautline::planning {

inline constexpr Range kProbability{0.0, 1.0};

/// A fuzzy membership, falling or rising, made a probability: `risk` where membership is 1, 0 where
/// it is 0, linear between. `full` and `none` are the values of the quantity where membership is 1
/// and 0.
struct Membership {
  double risk{0.0};
  double full{0.0};
  double none{1.0};

  [[nodiscard]] double of(double quantity) const noexcept {
    const double t =
        (none - quantity) / (none - full);  // 1 at full, 0 at none, whichever is larger
    return risk * (t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t);
  }
};

enum class RiskMode : std::uint8_t {
  kPerState,  ///< As published: each state has its risk, however near the last one is.
  kRate,      ///< Risk per way: independent of the resolution.
};
inline constexpr std::array<EnumName<RiskMode>, 2> kRiskModeNames{
    {{RiskMode::kPerState, "per_state"}, {RiskMode::kRate, "rate"}}};

enum class TurnLaw : std::uint8_t {
  kConstant,   ///< `risk` for every change of direction.
  kLinear,     ///< risk · ‖a_i − a_{i−1}‖, actions in metres (unit vectors in rate mode).
  kQuadratic,  ///< risk · ‖a_i − a_{i−1}‖².
  kThreshold,  ///< Linear for turns whose cosine is above `gentle_cosine`, `sharp_factor` times
               ///< that beyond.
};
inline constexpr std::array<EnumName<TurnLaw>, 4> kTurnLawNames{
    {{TurnLaw::kConstant, "constant"},
     {TurnLaw::kLinear, "linear"},
     {TurnLaw::kQuadratic, "quadratic"},
     {TurnLaw::kThreshold, "threshold"}}};

/// Distance to the closest obstacle, from the cell's centre to the surface of the nearest obstacle
/// cell.
struct DistanceParams {
  Membership member{0.05, 0.2, 1.2};
  double tolerance{0.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("risk", member.risk, kProbability, "at and below full_m; 0 = element off");
    v.field("full_m", member.full, Range{-10.0, 100.0}, "distance of full membership");
    v.field("none_m", member.none, Range{-10.0, 100.0}, "distance without risk, above full_m");
    v.field("tolerance_m", tolerance, Range{0.0, 10.0},
            "flight tolerance of the vehicle, taken off the distance");
  }
  void validate() const;
};

/// Scale of characteristic dimension E_cd/A_cd: width of the narrowest passage over the vehicle's.
/// At most 1 is granular: nothing gets through.
struct ScaleParams {
  Membership member{0.0, 1.0, 2.5};
  double agent_dimension{0.3};
  bool forbid_granular{true};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("risk", member.risk, kProbability, "at and below full; 0 = element off");
    v.field("full", member.full, Range{0.0, 100.0}, "E_cd/A_cd of full membership");
    v.field("none", member.none, Range{0.0, 100.0}, "E_cd/A_cd without risk, above full");
    v.field("agent_dimension_m", agent_dimension, Range{0.01, 10.0}, "A_cd: width of the vehicle");
    v.field("forbid_granular", forbid_granular,
            "E_cd/A_cd <= 1 is certain failure (only if the element is on)");
  }
  void validate() const;
};

/// Visibility: mean isovist length.
struct VisibilityParams {
  Membership member{0.04, 0.5, 4.0};
  int directions{0};
  double cap{10.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("risk", member.risk, kProbability, "at and below full_m; 0 = element off");
    v.field("full_m", member.full, Range{0.0, 100.0}, "mean isovist length of full membership");
    v.field("none_m", member.none, Range{0.0, 100.0},
            "mean isovist length without risk, above full_m");
    v.field("directions", directions, Range{0, 1024}, "rays; 0 = 98 in space, 64 in the plane");
    v.field("cap_m", cap, Range{0.1, 1000.0}, "longest length a ray counts for");
  }
  void validate() const;
};

/// Map layer "dynamic_threat": probabilities p per second; risk = 1 − (1 − p)^dwell.
struct ThreatParams {
  double dwell{0.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("dwell_s", dwell, Range{0.0, 3600.0}, "time in a state; 0 = element off");
  }
};

/// Elevation of the vehicle seen from the reel: the azimuth is lost straight above it. (A contact
/// moves the pole; the executor's own detour deals with that one, a state's locale does not know
/// the contact.)
struct SingularityParams {
  Membership member{0.0, 90.0, 70.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("risk", member.risk, kProbability, "at and above full_deg; 0 = element off");
    v.field("full_deg", member.full, Range{0.0, 90.0}, "elevation of full membership");
    v.field("none_deg", member.none, Range{0.0, 90.0}, "elevation without risk, below full_deg");
  }
  void validate() const;
};

/// Elements that a map layer gives: risk = scale · layer, layer values in [0, 1].
struct LayerParams {
  double scale{0.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("scale", scale, kProbability, "risk where the layer is 1; 0 = element off");
  }
};

struct ActionLengthParams {
  double per_metre{0.0911};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("per_m", per_metre, Range{0.0, 10.0}, "risk per metre of the action; 0 = element off");
  }
};

struct TurnParams {
  TurnLaw law{TurnLaw::kConstant};
  double risk{0.05};
  double gentle_cosine{0.7};
  double sharp_factor{12.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("law", law, kTurnLawNames, "how the risk grows with the change of direction");
    v.field(
        "risk", risk, Range{0.0, 10.0},
        "of a turn, or per metre of change (linear), or per square metre (quadratic); 0 = element "
        "off");
    v.field("gentle_cosine", gentle_cosine, Range{-1.0, 1.0},
            "threshold law: cosine of the sharpest gentle turn");
    v.field("sharp_factor", sharp_factor, Range{1.0, 1000.0}, "threshold law: of sharper turns");
  }
};

/// What changes between two states; only the way to the worse is risky: max(0, character(s_{i-1}) −
/// character(s_i)) · per_unit, character = passage width [m] (into the narrow) or visibility [m]
/// (into the confined).
enum class AccessCharacter : std::uint8_t { kWidth, kVisibility };
inline constexpr std::array<EnumName<AccessCharacter>, 2> kAccessCharacterNames{
    {{AccessCharacter::kWidth, "width"}, {AccessCharacter::kVisibility, "visibility"}}};

struct AccessParams {
  AccessCharacter character{AccessCharacter::kWidth};
  double per_unit{0.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("character", character, kAccessCharacterNames, "what the transition is judged by");
    v.field("per_m", per_unit, Range{0.0, 10.0}, "risk per metre lost; 0 = element off");
  }
};

struct TetherLengthParams {
  double per_metre{0.01};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("per_m", per_metre, Range{0.0, 1.0}, "risk per metre of taut tether; 0 = element off");
  }
};

struct ContactParams {
  double each{0.03};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("each", each, kProbability, "risk per contact; 0 = element off");
  }
};

/// Mud on the wheels: it grows by the map layer "slippage" (in [0, 1]) with each state, in rate
/// mode with each reference step; risk = per_mud · (mud gathered before this state) · layer(state).
struct SlippageParams {
  double per_mud{0.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("per_mud", per_mud, Range{0.0, 10.0},
            "risk per unit of mud on a fully slippery state; 0 = element off");
  }
};

/// Energy used grows with the way and the climb; risk is a membership of the used fraction of the
/// capacity.
struct BatteryParams {
  Membership member{0.0, 1.0, 0.5};
  double range{100.0};
  double climb_factor{1.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("risk", member.risk, kProbability, "with an empty battery; 0 = element off");
    v.field("full", member.full, Range{0.0, 1.0}, "used fraction of full membership");
    v.field("none", member.none, Range{0.0, 1.0}, "used fraction without risk, below full");
    v.field("range_m", range, Range{0.1, 1e6}, "way in level flight that empties the battery");
    v.field("climb_factor", climb_factor, Range{0.0, 100.0},
            "metres of level flight that a metre of climb adds");
  }
  void validate() const;
};

struct RiskParams {
  RiskMode mode{RiskMode::kPerState};
  double reference_step{0.4};
  double cap{0.95};
  double quantum{0.0};
  DistanceParams distance;
  ScaleParams scale;
  VisibilityParams visibility;
  ThreatParams dynamic_threat;
  SingularityParams singularity;
  LayerParams verticality;
  LayerParams lateral_inclination;
  LayerParams terrain_stability;
  LayerParams surface;
  ActionLengthParams action_length;
  TurnParams turn;
  AccessParams access;
  TetherLengthParams tether_length;
  ContactParams contacts;
  SlippageParams slippage;
  BatteryParams battery;
  TetherLimits tether_limits;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("mode", mode, kRiskModeNames, "risk a state (as published) or per way");
    v.field("reference_step_m", reference_step, Range{0.001, 100.0},
            "rate mode: way on which a state's risk is taken once");
    v.field("cap", cap, Range{0.0, 1.0}, "largest elementary risk that does not forbid");
    v.field("quantum", quantum, Range{0.0, 0.5},
            "per_state mode: elementary risks are rounded to its multiples; 0 = not");
    v.section("distance", distance);
    v.section("scale", scale);
    v.section("visibility", visibility);
    v.section("dynamic_threat", dynamic_threat);
    v.section("singularity", singularity);
    v.section("verticality", verticality);
    v.section("lateral_inclination", lateral_inclination);
    v.section("terrain_stability", terrain_stability);
    v.section("surface", surface);
    v.section("action_length", action_length);
    v.section("turn", turn);
    v.section("access", access);
    v.section("tether_length", tether_length);
    v.section("contacts", contacts);
    v.section("slippage", slippage);
    v.section("battery", battery);
    v.section("tether_limits", tether_limits);
  }
  void validate() const;
};

/// True if the parameters give the element any risk at all. What it also needs (a map layer, a
/// reel) may still be missing: it is then 0 everywhere.
[[nodiscard]] bool isOn(const RiskParams& params, RiskElement element) noexcept;

}  // namespace tautline::planning
