#include "planning_offline/planner/traverse.h"

#include "common/error.h"
#include "planning_offline/search/components.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kMovesKept = 4'000'000;  // then all are forgotten; 80 MB at most

}  // namespace

Traverse::Traverse(const RiskModel& risk)
    : risk_(&risk),
      rate_(risk.params().mode == RiskMode::kRate),
      tethered_(risk.hasTether()),
      muddy_(isOn(risk.params(), RiskElement::kSlippage)),
      draining_(isOn(risk.params(), RiskElement::kBattery)) {}

TraverseState Traverse::start(CellIndex cell) const {
  TraverseState state;
  if (tethered_) {
    TautString& string = *risk_->string();
    state.stack = string.move(kStraight, string.reel(), risk_->map().centre(cell));
  }
  return state;
}

double Traverse::startCost(CellIndex cell) {
  return risk_->startCost(cell) + risk_->startShare(stateCost(start(cell), cell));
}

double Traverse::stateCost(const TraverseState& state, CellIndex cell) {
  return (tethered_ ? tetherCost(state.stack, cell) : 0.0) +
         (summing() ? risk_->accumulatorCost(state.sums, cell) : 0.0);
}

double Traverse::tetherCost(StackId stack, CellIndex cell) {
  const TautString& string = *risk_->string();
  const Eigen::Vector3d position = risk_->map().centre(cell);
  const bool allowed =
      risk_->elevationAllowed(string.anchor(stack), position) && !string.touchesForbidden(stack);
  const double cost =
      allowed ? risk_->tetherCost(string.length(stack, position), string.contactCount(stack))
              : kInfiniteCost;
  if (!(cost < kInfiniteCost)) refused_ |= risk_->brokenLimits(stack, position);
  return cost;
}

double Traverse::step(TraverseState& state, CellIndex u, Direction incoming, Direction d,
                      CellIndex v) {
  const double cost = risk_->stepCost(u, incoming, d, v);
  if (!active() || !(cost < kInfiniteCost)) return cost;
  const double metres = stepLength(d) * risk_->map().resolution;
  const double before = rate_ ? stateCost(state, u) : 0.0;  // per state nothing asks for it
  if (tethered_) state.stack = moveString(state.stack, u, d, v);
  if (summing()) {
    // What nothing looks at must not tell labels apart.
    const Accumulators sums = risk_->advance(state.sums, u, v, metres);
    if (muddy_) state.sums.mud = sums.mud;
    if (draining_) state.sums.energy = sums.energy;
  }
  return cost + risk_->overStep(before, stateCost(state, v), metres);
}

StackId Traverse::moveString(StackId stack, CellIndex u, Direction d, CellIndex v) {
  constexpr StackId kStacks = StackId{1} << 28;  // more do not fit into keys, nor into memory
  if (moves_.size() >= kMovesKept) moves_.clear();
  const FlatIndex::Key key = static_cast<FlatIndex::Key>(stack) << 36 |
                             static_cast<FlatIndex::Key>(u) << 5 | static_cast<FlatIndex::Key>(d);
  StackId& next = moves_[key];
  if (next == FlatIndex::kNew) {
    next = risk_->string()->move(stack, risk_->map().centre(u), risk_->map().centre(v));
    TAUTLINE_CHECK(next < kStacks);
  }
  return next;
}

double Traverse::tetherBound(CellIndex v, Direction d) {
  if (!tethered_) return 0.0;
  const GridShape& shape = risk_->map().shape;
  const CellIndex u = shape.index(shape.cell(v) - stepOf(d));
  const double before = rate_ ? leastTetherCost(u) : 0.0;
  if (!(before < kInfiniteCost)) return kInfiniteCost;
  return risk_->overStep(before, leastTetherCost(v), stepLength(d) * risk_->map().resolution);
}

double Traverse::leastTetherCost(CellIndex cell) {
  const Eigen::Vector3d& reel = risk_->string()->reel();
  if (!contact_bound_) contact_bound_.emplace(risk_->map(), reel);
  const double straight = (risk_->map().centre(cell) - reel).norm();
  const int contacts = contact_bound_->at(cell);
  const double cost = risk_->tetherCost(straight, contacts);
  if (!(cost < kInfiniteCost)) {
    const TetherLimits& limits = risk_->params().tether_limits;
    refused_ |=
        {.length = !limits.allowsLength(straight), .contacts = !limits.allowsContacts(contacts)};
  }
  return cost;
}

}  // namespace tautline::planning
