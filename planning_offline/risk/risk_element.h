#pragma once

/// @file
/// The 16 risk elements of the dissertation (chapter 3), and how deep each looks into the path.
/// docs/risk.md defines each of them. Not real-time safe: offline only.

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/fields.h"

namespace tautline::planning {

enum class RiskElement : std::uint8_t {
  // locale: f(s_i)
  kDistance,
  kScale,
  kVisibility,
  kDynamicThreat,
  kSingularity,
  kVerticality,
  kInclination,
  kTerrain,
  kSurface,
  // action: f(s_{i-2}, s_{i-1}, s_i)
  kActionLength,
  kTurn,
  kAccess,
  // traverse: a fold over the whole path
  kTetherLength,
  kContacts,
  kSlippage,
  kBattery,
};
inline constexpr std::size_t kRiskElements = 16;
inline constexpr std::array<EnumName<RiskElement>, kRiskElements> kRiskElementNames{
    {{RiskElement::kDistance, "distance"},
     {RiskElement::kScale, "scale"},
     {RiskElement::kVisibility, "visibility"},
     {RiskElement::kDynamicThreat, "dynamic_threat"},
     {RiskElement::kSingularity, "singularity"},
     {RiskElement::kVerticality, "verticality"},
     {RiskElement::kInclination, "lateral_inclination"},
     {RiskElement::kTerrain, "terrain_stability"},
     {RiskElement::kSurface, "surface"},
     {RiskElement::kActionLength, "action_length"},
     {RiskElement::kTurn, "turn"},
     {RiskElement::kAccess, "access"},
     {RiskElement::kTetherLength, "tether_length"},
     {RiskElement::kContacts, "contacts"},
     {RiskElement::kSlippage, "slippage"},
     {RiskElement::kBattery, "battery"}}};

enum class RiskDepth : std::uint8_t { kLocale, kAction, kTraverse };
inline constexpr std::array<EnumName<RiskDepth>, 3> kRiskDepthNames{
    {{RiskDepth::kLocale, "locale"},
     {RiskDepth::kAction, "action"},
     {RiskDepth::kTraverse, "traverse"}}};

[[nodiscard]] constexpr RiskDepth depthOf(RiskElement e) noexcept {
  if (e <= RiskElement::kSurface) return RiskDepth::kLocale;
  return e <= RiskElement::kAccess ? RiskDepth::kAction : RiskDepth::kTraverse;
}

/// One value an element.
using PerElement = std::array<double, kRiskElements>;

}  // namespace tautline::planning
