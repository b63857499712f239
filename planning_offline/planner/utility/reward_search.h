#pragma once

/// @file
/// Best-first branch and bound over labels: a label is a path's end together with the set of what
/// it has visited. Not real-time safe: offline only.

#include <cstdint>
#include <queue>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/utility/candidates.h"
#include "planning_offline/planner/utility/reward_problem.h"

namespace tautline::planning {

class RewardSearch {
 public:
  /// kSimple: the visited set holds all cells, none is entered twice. kWalks: it holds the rewards
  /// only; far fewer labels, and since simple paths are walks, what bounds walks bounds them too.
  enum class Over : std::uint8_t { kSimple, kWalks };
  /// kBest leaves out what cannot beat the best utility, kFront what cannot extend the front.
  enum class Aim : std::uint8_t { kBest, kFront };

  /// Simple paths found go to `found`.
  RewardSearch(RewardProblem& problem, Over over, Aim aim, Candidates& found);

  /// Runs until nothing is left that could be better, or the budget is spent.
  void run(Budget& budget);

  [[nodiscard]] bool exhausted() const noexcept { return exhausted_; }
  /// No path that the search is over has more utility.
  [[nodiscard]] double upperBound() const;
  /// Utility of the best walk that is not simple, if it is better than every simple path found.
  [[nodiscard]] double bestWalk() const noexcept { return best_walk_; }
  [[nodiscard]] std::int64_t expanded() const noexcept { return expanded_; }

 private:
  using Id = std::int32_t;
  static constexpr Id kNone = -1;
  struct Label {
    PathPrefix path;
    Id parent{kNone};
    Id same_key{kNone};  // next label of the same end and visited set
    bool dominated{false};
  };
  using Word = std::uint64_t;

  void begin();
  void expand(Id id);
  void consider(const PathPrefix& path, Id parent);
  void add(const PathPrefix& path, Id parent);
  /// True if a label with the same future is at least as good; marks those that `path` beats.
  [[nodiscard]] bool dominated(const PathPrefix& path, Id head);
  [[nodiscard]] bool sameKey(const Label& label, Id id, const PathPrefix& path) const;
  [[nodiscard]] std::uint64_t key(const PathPrefix& path) const;
  void findAvailable(CellIndex from);
  [[nodiscard]] bool visited(CellIndex cell) const;
  [[nodiscard]] double toBeat() const;
  [[nodiscard]] std::vector<CellIndex> pathTo(CellIndex last, Id parent) const;
  [[nodiscard]] std::span<const Word> bitsOf(Id id) const;

  RewardProblem* problem_;
  Over over_;
  Aim aim_;
  Candidates* found_;
  std::vector<int> bit_at_;  // of a cell in the visited set, or -1
  std::size_t words_{0};     // of a visited set

  std::vector<Label> labels_;
  std::vector<Word> bits_;  // words_ a label
  std::unordered_map<std::uint64_t, Id> heads_;
  std::priority_queue<std::pair<double, Id>> open_;

  // Of the path under consideration:
  std::vector<Word> set_;
  std::vector<std::uint8_t> available_;  // items it may still collect
  std::vector<Word> seen_;               // cells of the flood
  std::vector<CellIndex> flood_;

  double best_walk_{-1.0};
  bool exhausted_{false};
  std::int64_t expanded_{0};
};

}  // namespace tautline::planning
