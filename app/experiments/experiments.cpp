#include "app/experiments/contact_watching.h"
#include "app/experiments/experiment.h"
#include "app/experiments/localization.h"
#include "app/experiments/reel_scale.h"

namespace tautline::experiments {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{kLocalization, kContactWatching, kReelScale};
  return all;
}

}  // namespace tautline::experiments
