#include "planning_offline/planner/utility/test/reward_world.h"

namespace tautline::planning::testing {
namespace {

class Enumeration {
 public:
  Enumeration(const RewardWorld& world, int paths_max,
              const std::function<void(const SimplePath&)>& visit)
      : world_(world), oracle_(world.world), left_(paths_max), visit_(visit) {}

  [[nodiscard]] bool run() {
    enter(oracle_.start());
    return left_ >= 0;
  }

 private:
  void enter(const Oracle::Tail& tail) {
    if (std::isinf(tail.cost) || --left_ < 0) return;
    const SimplePath before = path_;
    const double reward = world_.reward[static_cast<std::size_t>(tail.cell)];
    path_.cells.push_back(tail.cell);
    path_.cost = tail.cost;
    path_.reward += reward;
    path_.expected += reward * std::exp(-tail.cost);
    visit_(path_);
    for (const CellIndex next : oracle_.neighbours(tail.cell)) {
      if (std::find(path_.cells.begin(), path_.cells.end(), next) == path_.cells.end()) {
        enter(oracle_.step(tail, next));
      }
    }
    path_ = before;
  }

  const RewardWorld& world_;
  Oracle oracle_;
  int left_;
  const std::function<void(const SimplePath&)>& visit_;
  SimplePath path_;
};

}  // namespace

RewardWorld randomRewardWorld(const WorldKind& kind, std::uint32_t seed) {
  RewardWorld made{randomWorld(kind, seed), {}};
  Random random(seed + 1'000'000);
  const double rewarded = random.uniform(0.2, 1.0);
  const std::size_t cells = made.world.map->shape.size();
  for (std::size_t i = 0; i < cells; ++i) {
    made.reward.push_back(random.uniform(0.0, 1.0) < rewarded ? random.uniform(0.0, 1.0) : 0.0);
  }
  const auto start = static_cast<std::size_t>(made.world.start);
  // So that leaving pays: always in rate mode, where staying has no risk.
  made.reward[start] *= kind.mode == RiskMode::kRate ? 0.0 : 0.2;
  made.reward[(start + 1) % cells] = random.uniform(0.1, 1.0);  // perhaps out of reach
  return made;
}

bool forAllSimplePaths(const RewardWorld& world, int paths_max,
                       const std::function<void(const SimplePath&)>& visit) {
  return Enumeration(world, paths_max, visit).run();
}

}  // namespace tautline::planning::testing
