#include "control/control_config.h"

#include "common/error.h"

namespace tautline {

std::unique_ptr<Controller> makeController(const ControlConfig& config) {
  switch (config.law) {
    case Law::kComposite:
      return std::make_unique<CompositeLaw>(config.composite);
    case Law::kPosition:
      return std::make_unique<PositionLaw>(config.position);
    case Law::kVelocity:
      return std::make_unique<VelocityLaw>(config.velocity);
  }
  constexpr bool kLawIsKnown = false;
  TAUTLINE_CHECK(kLawIsKnown);
  return nullptr;
}

}  // namespace tautline
