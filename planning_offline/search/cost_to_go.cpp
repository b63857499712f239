#include "planning_offline/search/cost_to_go.h"

namespace tautline::planning {

CostToGo::CostToGo(const Lattice& lattice, const RiskModel& risk, CellIndex start, CellIndex goal,
                   Hooks hooks)
    : lattice_(&lattice),
      risk_(&risk),
      goal_(goal),
      hooks_(std::move(hooks)),
      components_(lattice, start),
      labels_(components_.size()) {
  if (start == goal) offer(components_.startId(), 0.0, kNoDirection);
  for (const Direction d : lattice.directions()) {
    offer(components_.id(goal, d), 0.0, kNoDirection);
  }
}

double CostToGo::cost(CellIndex cell, Direction incoming) {
  if (cell == goal_) return 0.0;
  const Label& label = settle(cell, incoming);
  return label.closed || queue_.empty() ? label.cost : queue_.top().first;
}

Direction CostToGo::next(CellIndex cell, Direction incoming) {
  if (cell == goal_) return kNoDirection;
  const Label& label = settle(cell, incoming);
  return label.closed ? Direction{label.next} : kNoDirection;
}

const CostToGo::Label& CostToGo::settle(CellIndex cell, Direction incoming) {
  const Label& wanted = labels_[static_cast<std::size_t>(components_.id(cell, incoming))];
  while (!wanted.closed && !queue_.empty() && !stopped_) {
    stopped_ = hooks_.stop && hooks_.stop();
    const Components::Id id = queue_.top().second;
    queue_.pop();
    Label& label = labels_[static_cast<std::size_t>(id)];
    if (label.closed) continue;
    label.closed = true;
    ++expanded_;
    expand(id);
  }
  return wanted;
}

void CostToGo::offer(Components::Id id, double cost, Direction next) {
  Label& label = labels_[static_cast<std::size_t>(id)];
  // Of equal costs the lower direction, so that the way does not depend on the order of the search.
  if (label.closed || !(std::pair(cost, next) < std::pair(label.cost, Direction{label.next}))) {
    return;
  }
  label.cost = cost;
  label.next = static_cast<std::int8_t>(next);
  queue_.emplace(cost, id);
}

void CostToGo::expand(Components::Id id) {
  if (id == components_.startId()) return;  // nothing comes before the start
  const CellIndex v = components_.cell(id);
  const Direction d = components_.direction(id);
  const std::uint32_t back = lattice_->moves(v);
  if ((back >> opposite(d) & 1U) == 0) return;  // moves are symmetric: nobody enters v by d
  const CellIndex u = lattice_->neighbour(v, opposite(d));
  const double to_go =
      labels_[static_cast<std::size_t>(id)].cost + (hooks_.extra ? hooks_.extra(v, d) : 0.0);
  const auto enter = [&](Direction incoming) {
    const double cost = to_go + risk_->stepCost(u, incoming, d, v);
    if (cost < kInfiniteCost) offer(components_.id(u, incoming), cost, d);
  };
  if (u == components_.cell(components_.startId())) enter(kNoDirection);
  for (const Direction incoming : lattice_->directions()) {
    if ((lattice_->moves(u) >> opposite(incoming) & 1U) != 0) enter(incoming);
  }
}

}  // namespace tautline::planning
