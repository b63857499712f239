#include "app/experiments/contact_watching.h"
#include "app/experiments/experiment.h"
#include "app/experiments/localization.h"
#include "app/experiments/path1.h"
#include "app/experiments/path2.h"
#include "app/experiments/reachable_space.h"
#include "app/experiments/real_logs.h"
#include "app/experiments/reel_scale.h"
#include "app/experiments/risk_truth.h"
#include "app/experiments/rough_air.h"
#include "app/experiments/servoing.h"
#include "app/experiments/staircase.h"
#include "app/experiments/tether_planning.h"

namespace tautline::experiments {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all{
      kLocalization,    kPath1,     kPath2,     kReachableSpace, kTetherPlanning, kServoing,
      kContactWatching, kReelScale, kStaircase, kRoughAir,       kRiskTruth,
  };
  return all;
}

const std::vector<Experiment>& realExperiments() {
  static const std::vector<Experiment> all{kRealLogs};
  return all;
}

}  // namespace tautline::experiments
