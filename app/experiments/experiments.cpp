#include "app/experiments/experiment.h"
#include "app/experiments/localization.h"
#include "app/experiments/servoing.h"

namespace tautline::experiments {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{kLocalization, kServoing};
  return all;
}

}  // namespace tautline::experiments
