#pragma once

/// @file
/// Which control law flies, and the settings of all of them.

#include <array>
#include <cstdint>
#include <memory>

#include "common/fields.h"
#include "control/composite_law.h"
#include "control/controller.h"
#include "control/position_law.h"
#include "control/velocity_law.h"

namespace tautline {

enum class Law : std::uint8_t { kComposite, kPosition, kVelocity };
inline constexpr std::array<EnumName<Law>, 3> kLawNames{
    {{Law::kComposite, "composite"}, {Law::kPosition, "position"}, {Law::kVelocity, "velocity"}}};

struct ControlConfig {
  Law law{Law::kComposite};
  CompositeLawConfig composite;
  PositionLawConfig position;
  VelocityLawConfig velocity;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("law", law, kLawNames, "control law in use");
    v.section("composite", composite);
    v.section("position", position);
    v.section("velocity", velocity);
  }
};

/// The law that `config` names. Not real-time safe: start-up only.
[[nodiscard]] std::unique_ptr<Controller> makeController(const ControlConfig& config);

}  // namespace tautline
