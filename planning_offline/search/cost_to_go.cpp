#include "planning_offline/search/cost_to_go.h"

namespace tautline::planning {

CostToGo::CostToGo(const Lattice& lattice, const RiskModel& risk, CellIndex start, CellIndex goal,
                   Hooks hooks)
    : lattice_(&lattice),
      risk_(&risk),
      start_(start),
      goal_(goal),
      hooks_(std::move(hooks)),
      count_(static_cast<Id>(lattice.directions().size())),
      number_(lattice.shape().size(), -1) {
  for (std::size_t k = 0; k < lattice.directions().size(); ++k) {
    slot_[static_cast<std::size_t>(lattice.directions()[k])] = static_cast<Id>(k);
  }
  cells_.reserve(lattice.freeCount());
  for (std::size_t i = 0; i < number_.size(); ++i) {
    const auto cell = static_cast<CellIndex>(i);
    if (!lattice.free(cell)) continue;
    number_[i] = static_cast<std::int32_t>(cells_.size());
    cells_.push_back(cell);
  }
  labels_.resize(cells_.size() * lattice.directions().size() + 1);
  if (start == goal) offer(startId(), 0.0, kNoDirection);
  if (!lattice.free(goal)) return;
  for (const Direction d : lattice.directions()) offer(idOf(goal, d), 0.0, kNoDirection);
}

double CostToGo::cost(CellIndex cell, Direction incoming) {
  if (cell == goal_) return 0.0;
  if (blocked(cell, incoming)) return kInfiniteCost;
  const Label& label = settle(cell, incoming);
  return label.closed || queue_.empty() ? label.cost : queue_.top().first;
}

Direction CostToGo::next(CellIndex cell, Direction incoming) {
  if (cell == goal_ || blocked(cell, incoming)) return kNoDirection;
  const Label& label = settle(cell, incoming);
  return label.closed ? Direction{label.next} : kNoDirection;
}

const CostToGo::Label& CostToGo::settle(CellIndex cell, Direction incoming) {
  const Label& wanted = labels_[static_cast<std::size_t>(idOf(cell, incoming))];
  while (!wanted.closed && !queue_.empty() && !stopped_) {
    stopped_ = hooks_.stop && hooks_.stop();
    const Id id = queue_.top().second;
    queue_.pop();
    Label& label = labels_[static_cast<std::size_t>(id)];
    if (label.closed) continue;
    label.closed = true;
    ++expanded_;
    expand(id);
  }
  return wanted;
}

void CostToGo::offer(Id id, double cost, Direction next) {
  Label& label = labels_[static_cast<std::size_t>(id)];
  // Of equal costs the lower direction, so that the way does not depend on the order of the search.
  if (label.closed || !(std::pair(cost, next) < std::pair(label.cost, Direction{label.next}))) {
    return;
  }
  label.cost = cost;
  label.next = static_cast<std::int8_t>(next);
  queue_.emplace(cost, id);
}

void CostToGo::expand(Id id) {
  if (id == startId()) return;  // nothing comes before the start
  const CellIndex v = cells_[static_cast<std::size_t>(id / count_)];
  const Direction d = lattice_->directions()[static_cast<std::size_t>(id % count_)];
  const std::uint32_t back = lattice_->moves(v);
  if ((back >> opposite(d) & 1U) == 0) return;  // moves are symmetric: nobody enters v by d
  const CellIndex u = lattice_->neighbour(v, opposite(d));
  const double to_go =
      labels_[static_cast<std::size_t>(id)].cost + (hooks_.extra ? hooks_.extra(v, d) : 0.0);
  const auto enter = [&](Direction incoming) {
    const double cost = to_go + risk_->stepCost(u, incoming, d, v);
    if (cost < kInfiniteCost) offer(idOf(u, incoming), cost, d);
  };
  if (u == start_) enter(kNoDirection);
  for (const Direction incoming : lattice_->directions()) {
    if ((lattice_->moves(u) >> opposite(incoming) & 1U) != 0) enter(incoming);
  }
}

}  // namespace tautline::planning
