#include "app/experiments/experiment.h"
#include "app/experiments/localization.h"

namespace tautline::experiments {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{kLocalization};
  return all;
}

}  // namespace tautline::experiments
