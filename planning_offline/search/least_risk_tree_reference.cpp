#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "planning_offline/search/components.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kAskEvery = 4096;  // expansions between two looks at Progress

class ReferenceTree final : public LeastRiskTree {
 public:
  ReferenceTree(const Lattice& lattice, const RiskModel& risk, CellIndex start)
      : lattice_(lattice), risk_(risk), components_(lattice, start), labels_(components_.size()) {}

  void grow(const Progress& progress);

  [[nodiscard]] double costTo(CellIndex cell) const override {
    const Components::Id best = bestComponent(cell);
    return best == Components::kNone ? kInfiniteCost : label(best).cost;
  }
  [[nodiscard]] std::optional<WalkEnd> lastOf(CellIndex cell) const override {
    const Components::Id best = bestComponent(cell);
    if (best == Components::kNone) return std::nullopt;
    return WalkEnd{cell, components_.direction(best)};
  }
  [[nodiscard]] WalkEnd before(const WalkEnd& end) const override {
    return {lattice_.neighbour(end.cell, opposite(end.incoming)),
            label(components_.id(end.cell, end.incoming)).before};
  }
  [[nodiscard]] double costError() const override { return 0.0; }
  [[nodiscard]] std::size_t expanded() const override { return expanded_; }
  [[nodiscard]] bool complete() const override { return complete_; }

 private:
  struct Label {
    double cost{kInfiniteCost};
    std::int32_t steps{0};
    std::int8_t before{kNoDirection};  // direction of the component that this one was reached from
    bool closed{false};
  };
  // Cheaper first, then shorter, then the lower cell, then the lower direction.
  using Entry = std::tuple<double, std::int32_t, Components::Id>;
  using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

  [[nodiscard]] const Label& label(Components::Id id) const {
    return labels_[static_cast<std::size_t>(id)];
  }
  [[nodiscard]] Label& label(Components::Id id) { return labels_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] Components::Id bestComponent(CellIndex cell) const;
  void expand(Components::Id id, Queue& queue);

  const Lattice& lattice_;
  const RiskModel& risk_;
  Components components_;
  std::vector<Label> labels_;
  std::size_t expanded_{0};
  bool complete_{false};
};

void ReferenceTree::grow(const Progress& progress) {
  Queue queue;
  const Components::Id start = components_.startId();
  label(start).cost = risk_.startCost(components_.cell(start));
  if (label(start).cost < kInfiniteCost) queue.emplace(label(start).cost, 0, start);
  const double all = static_cast<double>(lattice_.freeCount() * lattice_.directions().size());
  while (!queue.empty()) {
    const Components::Id id = std::get<2>(queue.top());
    queue.pop();
    if (label(id).closed) continue;
    label(id).closed = true;
    if (expanded_ % kAskEvery == 0) {
      if (progress.cancelled()) return;
      progress.report("least-risk paths", static_cast<double>(expanded_) / all);
    }
    ++expanded_;
    expand(id, queue);
  }
  complete_ = true;
}

void ReferenceTree::expand(Components::Id id, Queue& queue) {
  const CellIndex u = components_.cell(id);
  const Direction incoming = components_.direction(id);
  const std::uint32_t moves = lattice_.moves(u);
  for (const Direction d : lattice_.directions()) {
    if ((moves >> d & 1U) == 0) continue;
    const CellIndex v = lattice_.neighbour(u, d);
    const double cost = label(id).cost + risk_.stepCost(u, incoming, d, v);
    if (!(cost < kInfiniteCost)) continue;
    const std::int32_t steps = label(id).steps + 1;
    const Components::Id next = components_.id(v, d);
    Label& to = label(next);
    const auto rank = [](double c, std::int32_t n, Direction p) { return std::tuple(c, n, p); };
    if (to.closed || rank(cost, steps, incoming) >= rank(to.cost, to.steps, to.before)) continue;
    to.cost = cost;
    to.steps = steps;
    to.before = static_cast<std::int8_t>(incoming);
    queue.emplace(cost, steps, next);
  }
}

Components::Id ReferenceTree::bestComponent(CellIndex cell) const {
  Components::Id best = Components::kNone;
  const auto consider = [&](Components::Id id) {
    const Label& l = label(id);
    // Open labels of a cancelled search may still improve: they are no results.
    if (!l.closed) return;
    if (best == Components::kNone ||
        std::pair(l.cost, l.steps) < std::pair(label(best).cost, label(best).steps)) {
      best = id;
    }
  };
  if (cell == components_.cell(components_.startId())) consider(components_.startId());
  for (const Direction d : lattice_.directions()) consider(components_.id(cell, d));
  return best;
}

}  // namespace

std::unique_ptr<LeastRiskTree> leastRiskTreeReference(const Lattice& lattice, const RiskModel& risk,
                                                      CellIndex start, const Progress& progress) {
  auto tree = std::make_unique<ReferenceTree>(lattice, risk, start);
  tree->grow(progress);
  return tree;
}

}  // namespace tautline::planning
