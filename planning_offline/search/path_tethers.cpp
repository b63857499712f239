#include "planning_offline/search/path_tethers.h"

#include <algorithm>
#include <limits>
#include <string>

#include "common/error.h"
#include "planning_offline/search/components.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kAskEvery = 4096;  // cells between two looks at Progress
constexpr const char* kWhat = "tether along the paths";

constexpr std::size_t kMost = std::size_t{1} << 27;  // components, for Tethered::next

InputError tooMany(const VoxelMap& map, const char* what) {
  return InputError(
      {.file = map.file,
       .problem = std::string("has too many ") + what + " for tethers along all paths",
       .allowed = "fewer than " + std::to_string(kMost),
       .remedy = "a larger --resolution, or a --crop"});
}

/// Of a component on the way of some path.
struct Tethered {
  StackId stack{kStraight};
  std::uint32_t next : 27 {0};     ///< Another component of the same cell; 0 = none.
  std::uint32_t incoming : 5 {0};  ///< Direction, or kNoDirection.
  std::uint32_t contacts_most : 29 {0};
  std::uint32_t length_allowed : 1 {1};
  std::uint32_t elevation_allowed : 1 {1};
  std::uint32_t contact_allowed : 1 {1};
};
static_assert(sizeof(Tethered) == 12);

/// The walk over the tree. A path is followed back until it meets a component that another path has
/// been through, and its string is moved from there on: a depth-first walk over the union of the
/// paths that needs no lists of children.
class TetherWalk {
 public:
  TetherWalk(const Lattice& lattice, const RiskModel& risk, const LeastRiskTree& tree)
      : risk_(risk),
        string_(*risk.string()),
        tree_(tree),
        first_(lattice.shape().size(), 0),
        known_(1) {
    known_.reserve(lattice.freeCount() + lattice.freeCount() / 4);
  }

  /// The component that the path to a cell ends in; 0 if there is no path.
  [[nodiscard]] std::uint32_t at(CellIndex cell);
  [[nodiscard]] const Tethered& operator[](std::uint32_t i) const { return known_[i]; }
  [[nodiscard]] std::size_t moves() const noexcept { return known_.size() - 1; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return first_.capacity() * sizeof first_[0] + known_.capacity() * sizeof known_[0] +
           way_.capacity() * sizeof way_[0];
  }

 private:
  [[nodiscard]] std::uint32_t find(const WalkEnd& end) const;
  [[nodiscard]] std::uint32_t add(const WalkEnd& end, Tethered tether);
  [[nodiscard]] Tethered moved(const Tethered& from, const Eigen::Vector3d& p,
                               const Eigen::Vector3d& q);

  const RiskModel& risk_;
  TautString& string_;
  const LeastRiskTree& tree_;
  std::vector<std::uint32_t> first_;  // of each cell, into known_; 0 = none
  std::vector<Tethered> known_;       // the first is no component
  std::vector<WalkEnd> way_;          // back from a path's end, kept for its memory
};

std::uint32_t TetherWalk::find(const WalkEnd& end) const {
  std::uint32_t i = first_[static_cast<std::size_t>(end.cell)];
  while (i != 0 && known_[i].incoming != static_cast<std::uint32_t>(end.incoming)) {
    i = known_[i].next;
  }
  return i;
}

std::uint32_t TetherWalk::add(const WalkEnd& end, Tethered tether) {
  if (known_.size() >= kMost) throw tooMany(risk_.map(), "states of paths");
  std::uint32_t& first = first_[static_cast<std::size_t>(end.cell)];
  tether.incoming = static_cast<std::uint32_t>(end.incoming) & 31U;
  tether.next = first & (kMost - 1);
  first = static_cast<std::uint32_t>(known_.size());
  known_.push_back(tether);
  return first;
}

Tethered TetherWalk::moved(const Tethered& from, const Eigen::Vector3d& p,
                           const Eigen::Vector3d& q) {
  constexpr std::uint32_t kMostContacts = (1U << 29U) - 1U;
  Tethered to = from;
  to.stack = string_.move(from.stack, p, q);
  const auto contacts = static_cast<std::uint32_t>(string_.contactCount(to.stack));
  if (contacts > to.contacts_most) to.contacts_most = contacts & kMostContacts;
  if (!risk_.params().tether_limits.allowsLength(string_.length(to.stack, q))) {
    to.length_allowed = 0;
  }
  if (!risk_.elevationAllowed(string_.anchor(to.stack), q)) to.elevation_allowed = 0;
  if (string_.touchesForbidden(to.stack)) to.contact_allowed = 0;
  return to;
}

std::uint32_t TetherWalk::at(CellIndex cell) {
  const std::optional<WalkEnd> last = tree_.lastOf(cell);
  if (!last) return 0;
  way_.clear();
  WalkEnd end = *last;
  std::uint32_t known = find(end);
  while (known == 0) {
    way_.push_back(end);
    if (end.incoming == kNoDirection) break;
    end = tree_.before(end);
    known = find(end);
  }
  Eigen::Vector3d position = known == 0 ? string_.reel() : risk_.map().centre(end.cell);
  for (; !way_.empty(); way_.pop_back()) {
    const Eigen::Vector3d next = risk_.map().centre(way_.back().cell);
    known = add(way_.back(), moved(known_[known], position, next));
    position = next;
  }
  return known;
}

}  // namespace

PathTethers tethersOfPaths(const Lattice& lattice, const RiskModel& risk, const LeastRiskTree& tree,
                           const Progress& progress) {
  TAUTLINE_CHECK(risk.string() != nullptr);
  if (lattice.freeCount() >= kMost) throw tooMany(risk.map(), "free cells");
  const TautString& string = *risk.string();
  const std::size_t cells = lattice.shape().size();
  PathTethers out;
  out.length.assign(cells, kInfiniteCost);
  out.contacts.assign(cells, -1);
  out.contacts_most.assign(cells, -1);
  out.length_allowed.assign(cells, 0);
  out.elevation_allowed.assign(cells, 0);
  out.contact_allowed.assign(cells, 0);
  TetherWalk walk(lattice, risk, tree);
  bool cancelled = false;
  for (std::size_t i = 0; i < cells && !cancelled; ++i) {
    if (i % kAskEvery == 0) {
      progress.report(kWhat, static_cast<double>(i) / static_cast<double>(cells));
      cancelled = progress.cancelled();
    }
    const auto cell = static_cast<CellIndex>(i);
    if (cancelled || !lattice.free(cell)) continue;
    const std::uint32_t end = walk.at(cell);
    if (end == 0) continue;
    const Tethered& tether = walk[end];
    out.length[i] = string.length(tether.stack, risk.map().centre(cell));
    out.contacts[i] = string.contactCount(tether.stack);
    out.contacts_most[i] = static_cast<std::int32_t>(tether.contacts_most);
    out.length_allowed[i] = tether.length_allowed;
    out.elevation_allowed[i] = tether.elevation_allowed;
    out.contact_allowed[i] = tether.contact_allowed;
  }
  out.moves = walk.moves();
  out.bytes = walk.bytes();
  out.complete = !cancelled && tree.complete();
  return out;
}

}  // namespace tautline::planning
