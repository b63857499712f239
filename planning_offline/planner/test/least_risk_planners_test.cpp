/// What each planner of least risk is for.

#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/planner/additive_cost.h"
#include "planning_offline/planner/choose_goal.h"
#include "planning_offline/planner/test/planner_test_kit.h"

namespace tautline::planning {
namespace {

using testing::cellAt;
using testing::emptyWorld;
using testing::Oracle;
using testing::picture;
using testing::planTo;
using testing::problemOf;
using testing::randomWorld;
using testing::rewardsAt;
using testing::SmallWorld;
using testing::truthOf;

/// The dissertation's figure: a muddy way to a clean place u that all ways share, and mud behind
/// it. To u the mud does no harm; behind u it does, and no look-back sees that far.
SmallWorld muddyWorld() {
  SmallWorld world = picture({".......#####",  //
                              ".#####......",  //
                              "s.mm........",  //
                              "############"},
                             Connectivity::kFaces);
  for (const int x : {10, 11}) {
    world.map->layers[0].values[static_cast<std::size_t>(cellAt(world, x, 1))] = 1.0;
  }
  for (int x = 7; x < 12; ++x) {  // one corridor behind u
    world.map->cells[static_cast<std::size_t>(cellAt(world, x, 2))] = CellState::kOccupied;
  }
  world.params.turn = {.law = TurnLaw::kConstant, .risk = 0.05};
  world.params.slippage.per_mud = 0.2;
  world.build();
  return world;
}

TEST(DirectionalMustFailOnTraverseRisk, OfMud) {
  const SmallWorld world = muddyWorld();
  const CellIndex u = cellAt(world, 7, 1);
  const CellIndex v = cellAt(world, 11, 1);
  const PlanResult directional = planTo(*makeDirectional(), world, v);
  const PlanResult tether = planTo(*makeTether(), world, v);
  const auto truth = truthOf(world);
  ASSERT_TRUE(truth.known);
  EXPECT_NEAR(tether.report.cost, truth.simple[static_cast<std::size_t>(v)], 1e-12);
  RecordProperty("directional", std::to_string(directional.report.risk));
  RecordProperty("tether", std::to_string(tether.report.risk));
  EXPECT_GT(directional.report.risk, tether.report.risk + 0.05);
  EXPECT_EQ(directional.status, PlanStatus::kFeasible);
  EXPECT_LE(*directional.risk_lower_bound, tether.report.risk);
  // The way through the mud is the best one to u.
  EXPECT_NEAR(planTo(*makeDirectional(), world, u).report.cost,
              truth.simple[static_cast<std::size_t>(u)], 1e-12);
  // Looking back further does not help: the ways have been one for longer.
  for (const int n : {3, 4}) {
    PlanOptions options;
    options.lookback = n;
    EXPECT_GT(planTo(*makeLookback(), world, v, options).report.risk, tether.report.risk + 0.05);
  }
}

TEST(Lookback, SeesMudThatIsNearEnough) {
  // As above, but the mud begins one step behind the place where the ways join: of the last two
  // directions there, one differs.
  SmallWorld world = picture({"....##",  //
                              ".##..m",  //
                              "s.m.#m",  //
                              "######"},
                             Connectivity::kFaces);
  world.params.slippage.per_mud = 0.3;
  world.params.turn = {.law = TurnLaw::kLinear, .risk = 0.01};  // or going to and fro were as good
  world.build();
  const CellIndex goal = cellAt(world, 5, 1);
  const double best = planTo(*makeTether(), world, goal).report.risk;
  EXPECT_GT(planTo(*makeDirectional(), world, goal).report.risk, best + 0.1);
  for (const int n : {3, 4}) {
    PlanOptions options;
    options.lookback = n;
    EXPECT_NEAR(planTo(*makeLookback(), world, goal, options).report.risk, best, 1e-12);
  }
}

TEST(Additive, CostsAreEachElementsSumOverItsLargest) {
  SmallWorld world = picture({"sd."}, Connectivity::kFaces);
  world.map->layers.push_back({"terrain_stability", {0.5, 0.25, 0.0}});
  world.params.surface.scale = 0.1;
  world.params.terrain_stability.scale = 0.4;
  world.build();
  const auto plain = additiveCosts(*world.lattice, *world.risk, AdditiveWeights::kPlain);
  EXPECT_NEAR(plain[0], 0.2, 1e-15);
  EXPECT_NEAR(plain[1], 0.2, 1e-15);
  const auto normalized = additiveCosts(*world.lattice, *world.risk, AdditiveWeights::kNormalized);
  EXPECT_NEAR(normalized[0], 1.0, 1e-15);
  EXPECT_NEAR(normalized[1], 1.5, 1e-15);
  EXPECT_NEAR(normalized[2], 0.0, 1e-15);
}

TEST(Additive, MakesTheDetourThatLocaleRisksAskFor) {
  // Squeezing through the dark gap is short; the conventional planner goes all the way round.
  SmallWorld world = picture({".........",  //
                              ".#######.",  //
                              "s...d....",  //
                              "########."},
                             Connectivity::kFaces);
  world.params.surface.scale = 0.05;
  world.params.turn = {.law = TurnLaw::kConstant, .risk = 0.05};
  world.build();
  const CellIndex goal = cellAt(world, 8, 1);
  const PlanResult additive = planTo(*makeAdditive(), world, goal);
  const PlanResult directional = planTo(*makeDirectional(), world, goal);
  EXPECT_EQ(additive.status, PlanStatus::kOptimal);
  EXPECT_GT(additive.path.size(), directional.path.size());
  EXPECT_GT(additive.report.risk, directional.report.risk);
  EXPECT_FALSE(additive.risk_lower_bound.has_value());
}

TEST(Additive, LedToAGoalItsPathIsTheSame) {
  SmallWorld ties = emptyWorld({6, 1, 5}, Connectivity::kVertices);
  ties.build();
  const SmallWorld random = randomWorld({.connectivity = Connectivity::kVertices}, 7);
  const auto never = [] { return false; };
  for (const SmallWorld* world : {&std::as_const(ties), &random}) {
    std::vector<double> costs =
        additiveCosts(*world->lattice, *world->risk, AdditiveWeights::kPlain);
    for (const double more : {0.0, 0.25}) {
      for (double& cost : costs) cost += more;
      const AdditivePaths all = additivePaths(*world->lattice, costs, world->start, never);
      bool less = false;
      for (CellIndex goal = 0; goal < static_cast<CellIndex>(costs.size()); ++goal) {
        const AdditivePaths led = additivePaths(*world->lattice, costs, world->start, never, goal);
        EXPECT_EQ(led.pathTo(goal), all.pathTo(goal));
        EXPECT_EQ(led.cost[static_cast<std::size_t>(goal)],
                  all.cost[static_cast<std::size_t>(goal)]);
        EXPECT_LE(led.expanded, all.expanded);
        less = less || led.expanded < all.expanded;
      }
      EXPECT_TRUE(less);
    }
  }
}

TEST(Tether, KeepsWithinItsLimits) {
  // Straight on is shortest, but leads round the wall: more contacts and tether than allowed.
  SmallWorld world = picture({".........",  //
                              ".####.##.",  //
                              ".#....#..",  //
                              "s..####..",  //
                              "........."},
                             Connectivity::kVertices);
  world.tethered = true;
  world.params.tether_limits.contacts_max = 1;
  world.build();
  Oracle oracle(world);
  const auto truth = truthOf(world);
  int limited = 0;
  for (CellIndex goal = 0; goal < static_cast<CellIndex>(world.map->shape.size()); ++goal) {
    if (!world.isFree(goal)) continue;
    const PlanResult result = planTo(*makeTether(), world, goal);
    if (!result) {
      EXPECT_EQ(result.status, PlanStatus::kUnreachable);
      ++limited;
      continue;
    }
    EXPECT_TRUE(std::isfinite(oracle.costOf(result.path)));
    for (const StateRisk& state : result.report.states) EXPECT_LE(state.contacts.size(), 1U);
  }
  EXPECT_GT(limited, 0);
}

/// Random obstacles that a tether gets caught on.
SmallWorld hall(std::uint32_t seed) {
  testing::Random random(seed);
  SmallWorld world = emptyWorld({24, 1, 24}, Connectivity::kEdges);
  for (CellState& state : world.map->cells) {
    if (random.uniform(0.0, 1.0) < 0.15) state = CellState::kOccupied;
  }
  world.map->cells[0] = CellState::kFree;
  world.map->cells[static_cast<std::size_t>(cellAt(world, 23, 20))] = CellState::kFree;
  world.tethered = true;
  world.params.tether_length.per_metre = 0.005;
  world.params.contacts.each = 0.1;
  world.params.turn.risk = 0.02;
  world.build();
  return world;
}

TEST(Tether, IsNeverWorseThanDirectionalOnLargerMaps) {
  int goals = 0;
  int better = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const SmallWorld world = hall(seed);
    for (CellIndex goal = 15; goal < 576; goal += 80) {
      if (!world.isFree(goal)) continue;
      const PlanResult directional = planTo(*makeDirectional(), world, goal);
      const PlanResult tether = planTo(*makeTether(), world, goal);
      ASSERT_EQ(static_cast<bool>(directional), static_cast<bool>(tether));
      if (!tether) continue;
      ASSERT_EQ(tether.status, PlanStatus::kOptimal);
      EXPECT_LE(tether.report.cost, directional.report.cost + 1e-12);
      EXPECT_LE(*directional.risk_lower_bound, tether.report.risk + 1e-12);
      ++goals;
      if (tether.report.cost < directional.report.cost - 1e-9) ++better;
    }
  }
  RecordProperty("goals", goals);
  RecordProperty("better", better);
  EXPECT_GT(better, 0);
}

TEST(Exact, ChoosesTheBestEndByRatioWithoutAGoal) {
  SmallWorld world = picture({"s...."}, Connectivity::kFaces);
  world.params.action_length.per_metre = 0.1;
  world.build();
  // Risks 0.1, 0.19, 0.271, 0.3439: ratios 10, 26.3, 18.5, 17.4.
  const auto reward = rewardsAt(world, {{1, 1.0}, {2, 4.0}, {4, 1.0}});
  const PlanResult result = makeExact()->plan(problemOf(world, reward), {}, Progress());
  EXPECT_EQ(result.status, PlanStatus::kOptimal);
  EXPECT_EQ(result.path, (std::vector<CellIndex>{0, 1, 2}));
  EXPECT_NEAR(result.utility, 5.0 / 0.19, 1e-12);
  EXPECT_NEAR(result.reward, 5.0, 1e-15);
  EXPECT_EQ(result.utility_upper_bound, result.utility);
}

TEST(Exact, SaysWhetherTheRiskCapIsInTheWay) {
  SmallWorld world = picture({"s...#."}, Connectivity::kFaces);
  world.params.action_length.per_metre = 0.1;
  world.build();
  PlanOptions options;
  options.risk_cap = 0.05;
  EXPECT_EQ(planTo(*makeExact(), world, 3, options).text,
            "no path to the goal within the risk cap");
  EXPECT_EQ(planTo(*makeExact(), world, 5, options).text, "no path to the goal");
}

TEST(Exact, DiscountsWhatIsBehind) {
  SmallWorld world = picture({"s...."}, Connectivity::kFaces);
  world.params.action_length.per_metre = 0.1;
  world.build();
  auto reward = rewardsAt(world, {{0, 1.0}, {1, 1.0}, {2, 4.0}, {4, 100.0}});
  PlanOptions options;
  options.goal = 2;
  options.discount = 0.5;
  EXPECT_NEAR(makeExact()->plan(problemOf(world, reward), options, Progress()).reward,
              0.25 + 0.5 + 4.0, 1e-15);
  options.discount = 0.0;  // the printed algorithm divides by it
  EXPECT_NEAR(makeExact()->plan(problemOf(world, reward), options, Progress()).reward, 4.0, 1e-15);
  options.goal.reset();
  reward[0] = 0.0;  // staying risks nothing here
  const PlanResult best = makeExact()->plan(problemOf(world, reward), options, Progress());
  EXPECT_EQ(best.path.back(), 4);
  EXPECT_NEAR(best.utility, 100.0 / best.report.risk, 1e-9);
}

/// The greatest utility of all simple paths, by trying them all.
double bestUtility(const SmallWorld& world, Oracle& oracle, const std::vector<double>& reward,
                   Objective objective, double cap, const Oracle::Tail& tail, double value,
                   std::vector<CellIndex>& path) {
  const double risk = 1.0 - std::exp(-tail.cost);
  if (!std::isfinite(tail.cost) || risk > cap) return -1.0;
  const bool expected = objective == Objective::kExpectedReward;
  value += reward[static_cast<std::size_t>(tail.cell)] * (expected ? std::exp(-tail.cost) : 1.0);
  double best = expected ? value : (value > 0.0 ? value / risk : 0.0);
  path.push_back(tail.cell);
  for (const CellIndex next : oracle.neighbours(tail.cell)) {
    if (std::find(path.begin(), path.end(), next) != path.end()) continue;
    best = std::max(best, bestUtility(world, oracle, reward, objective, cap,
                                      oracle.step(tail, next), value, path));
  }
  path.pop_back();
  return best;
}

TEST(Exact, HasTheGreatestUtilityOfAllSimplePaths) {
  int maps = 0;
  for (int k = 0; k < testing::kKinds; ++k) {
    testing::WorldKind kind = testing::kindNumber(k);
    kind.tether = k % 2 == 0;
    kind.mud = k % 3 == 0;
    for (std::uint32_t seed = 500; seed < 506; ++seed) {
      const SmallWorld world = randomWorld(kind, seed + 100U * static_cast<std::uint32_t>(k));
      Oracle oracle(world);
      std::vector<double> ignored;
      if (!oracle.simpleOptima(5000, ignored)) continue;
      // In rate mode staying risks nothing: any reward at the start would be infinite.
      testing::Random random(seed);
      std::vector<double> reward(world.map->shape.size());
      for (double& r : reward) r = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 1.0);
      reward[static_cast<std::size_t>(world.start)] = 0.0;
      for (const Objective objective : {Objective::kRatio, Objective::kExpectedReward}) {
        PlanOptions options;
        options.objective = objective;
        options.risk_cap = seed % 2 == 0 ? 1.0 : 0.4;
        std::vector<CellIndex> path;
        const double expected = bestUtility(world, oracle, reward, objective, options.risk_cap,
                                            oracle.start(), 0.0, path);
        const PlanResult result = makeExact()->plan(problemOf(world, reward), options, Progress());
        if (expected < 0.0) {
          EXPECT_EQ(result.status, PlanStatus::kUnreachable);
          continue;
        }
        ASSERT_NEAR(result.utility, expected, 1e-9 * (1.0 + expected)) << "kind " << k;
        EXPECT_LE(result.report.risk, options.risk_cap + 1e-12);
        ++maps;
      }
    }
  }
  EXPECT_GT(maps, 200);
}

TEST(ChooseGoal, TakesTheBestOfTheLeastRiskyPathsAndStayingIsOne) {
  SmallWorld world = picture({"s...."}, Connectivity::kFaces);
  world.params.action_length.per_metre = 0.1;
  world.build();
  const auto cost = [](CellIndex cell) { return costOfRisk(0.01 + 0.1 * cell); };
  const auto path = [](CellIndex cell) {
    std::vector<CellIndex> cells;
    for (CellIndex i = 0; i <= cell; ++i) cells.push_back(i);
    return cells;
  };
  const auto choose = [&](const std::vector<double>& reward, double cap) {
    PlanOptions options;
    options.risk_cap = cap;
    return chooseGoal(problemOf(world, reward), options, {cost, path}, Progress());
  };
  EXPECT_EQ(choose(rewardsAt(world, {{3, 1.0}}), 1.0)->goal, 3);
  EXPECT_EQ(choose(rewardsAt(world, {{0, 0.05}, {3, 1.0}}), 1.0)->goal, 0);  // 5 > 1.05 / 0.31
  EXPECT_EQ(choose(rewardsAt(world, {{1, 0.1}, {3, 1.0}}), 0.25)->goal, 1);
  EXPECT_FALSE(choose(rewardsAt(world, {{1, 0.1}}), 0.001).has_value());
}

TEST(ChooseGoal, JudgesExpectedRewardsByTheModel) {
  SmallWorld world = picture({"s...."}, Connectivity::kFaces);
  world.params.action_length.per_metre = 0.5;
  world.build();
  PlanOptions options;
  options.objective = Objective::kExpectedReward;
  const auto reward = rewardsAt(world, {{1, 1.0}, {3, 0.5}});
  for (const auto& planner : {makeDirectional(), makeTether(), makeExact(), makeAdditive()}) {
    const PlanResult result = planner->plan(problemOf(world, reward), options, Progress());
    EXPECT_EQ(result.path.back(), 3);
    EXPECT_NEAR(result.utility, 0.5 + 0.5 * 0.125, 1e-12);
  }
}

TEST(DescribePath, CountsARewardOncePerCell) {
  SmallWorld world = picture({"s.."}, Connectivity::kFaces);
  world.build();
  const auto reward = rewardsAt(world, {{0, 1.0}, {1, 2.0}});
  PlanResult result;
  result.path = {0, 1, 0, 1, 2};
  describePath(problemOf(world, reward), {}, result);
  EXPECT_FALSE(result.simple);
  EXPECT_EQ(result.reward, 3.0);
  EXPECT_NEAR(result.utility, 3.0 / result.report.risk, 1e-12);
  EXPECT_EQ(result.report.states.size(), 5U);
}

TEST(UtilityOf, ARewardWithoutRiskIsInfinitelyGood) {
  SmallWorld world = picture({"s."}, Connectivity::kFaces);
  world.build();
  const std::vector<CellIndex> stay{0};
  const RiskReport report = world.risk->evaluate(stay);
  EXPECT_TRUE(std::isinf(utilityOf(rewardsAt(world, {{0, 1.0}}), stay, report, Objective::kRatio)));
  EXPECT_EQ(utilityOf(rewardsAt(world, {{1, 1.0}}), stay, report, Objective::kRatio), 0.0);
  EXPECT_EQ(utilityOf({}, stay, report, Objective::kExpectedReward), 0.0);
}

/// A room with so many ways round its pillars that small limits do not suffice.
SmallWorld pillars() {
  SmallWorld world = emptyWorld({17, 1, 17}, Connectivity::kEdges);
  for (int z = 2; z < 16; z += 3) {
    for (int x = 2; x < 16; x += 3) {
      world.map->cells[static_cast<std::size_t>(cellAt(world, x, z))] = CellState::kOccupied;
    }
  }
  world.tethered = true;
  world.params.tether_length.per_metre = 0.01;
  world.params.contacts.each = 0.15;
  world.params.turn.risk = 0.02;
  world.build();
  return world;
}

TEST(Tether, CutByLabelsItHasAPathAndAGap) {
  const SmallWorld world = pillars();
  const CellIndex goal = cellAt(world, 12, 16);
  const PlanResult whole = planTo(*makeTether(), world, goal);
  ASSERT_EQ(whole.status, PlanStatus::kOptimal);
  PlanOptions options;
  options.label_limit = 20;
  const PlanResult cut = planTo(*makeTether(), world, goal, options);
  ASSERT_EQ(cut.status, PlanStatus::kCut) << cut.text;
  EXPECT_NE(cut.text.find("label limit"), std::string::npos);
  EXPECT_EQ(cut.path.back(), goal);
  EXPECT_GE(cut.report.risk, whole.report.risk);
  EXPECT_LE(*cut.risk_lower_bound, whole.report.risk);
  EXPECT_GT(*cut.risk_lower_bound, 0.0);
}

TEST(Exact, CutByPathsItHasTheBestSoFar) {
  const SmallWorld world = pillars();
  const CellIndex goal = cellAt(world, 12, 16);
  PlanOptions options;
  options.label_limit = 5000;
  std::vector<double> reward(world.map->shape.size(), 0.01);
  reward[static_cast<std::size_t>(world.start)] = 0.0;  // staying risks nothing
  const PlanResult result = makeExact()->plan(problemOf(world, reward), options, Progress());
  EXPECT_EQ(result.status, PlanStatus::kCut);
  EXPECT_FALSE(result.path.empty());
  EXPECT_FALSE(result.utility_upper_bound.has_value());
  const PlanResult tether = planTo(*makeTether(), world, goal);
  const PlanResult to_goal = planTo(*makeExact(), world, goal, options);
  ASSERT_TRUE(to_goal) << to_goal.text;
  EXPECT_GE(to_goal.report.risk, tether.report.risk - 1e-12);
  EXPECT_LE(*to_goal.risk_lower_bound, tether.report.risk + 1e-12);
}

TEST(Lookback, OutOfTimeItHasAtLeastThePathWithoutATether) {
  const SmallWorld world = pillars();
  const CellIndex goal = cellAt(world, 12, 16);
  PlanOptions options;
  options.time_limit = 0.0;
  const PlanResult result = planTo(*makeLookback(), world, goal, options);
  EXPECT_EQ(result.status, PlanStatus::kCut);
  EXPECT_NE(result.text.find("time limit"), std::string::npos);
  ASSERT_TRUE(result);
  EXPECT_EQ(result.path.back(), goal);
  const PlanResult tether = planTo(*makeTether(), world, goal);
  EXPECT_GE(result.report.risk, tether.report.risk - 1e-12);
  EXPECT_LE(*result.risk_lower_bound, tether.report.risk + 1e-12);
}

TEST(Tether, CancelledOnTheWayItKeepsTheBestSoFar) {
  const SmallWorld world = hall(3);
  PlanOptions options;
  options.goal = cellAt(world, 23, 20);
  std::set<PlanStatus> seen;
  for (int allowed = 1; !seen.contains(PlanStatus::kOptimal); ++allowed) {
    ASSERT_LT(allowed, 1000);
    Progress* handle = nullptr;
    int reports = 0;
    Progress progress([&](std::string_view, double) {
      if (++reports == allowed) handle->cancel();
    });
    handle = &progress;
    const PlanResult result = makeTether()->plan(problemOf(world), options, progress);
    seen.insert(result.status);
    if (!result.path.empty()) {
      EXPECT_EQ(result.path.back(), *options.goal);
    }
  }
  EXPECT_EQ(seen, (std::set{PlanStatus::kNone, PlanStatus::kCut, PlanStatus::kOptimal}));
}

}  // namespace
}  // namespace tautline::planning
