#include "planning_offline/search/fast/bucket_expansion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "planning_offline/multiversion.h"

namespace tautline::planning {
namespace {

using Lanes16 = UnitCosts::Lanes16;
using Lanes32 = UnitCosts::Lanes32;

constexpr int kGateShift = 3;       // 8 units are one of a gate
constexpr std::size_t kBatch = 32;  // cells whose memory is asked for before it is used
constexpr std::size_t kRows = 9;    // of three cells along x, around a cell
constexpr std::size_t kCentreRow = 4;

constexpr std::size_t at(Direction d) { return static_cast<std::size_t>(d); }

/// A cell to expand, and the numbers of its neighbourhood.
struct Expansion {
  CellIndex cell;
  std::uint32_t number;
  std::uint32_t moves;
  std::array<std::uint32_t, kRows> middle;  // number of each row's middle cell …
  std::array<std::uint32_t, kRows> right;   // … and of the one right of it
};

/// A label offered to a neighbour.
struct Offer {
  CellIndex cell;
  std::uint32_t number;
  std::uint32_t cost;  // above the start of the bucket being expanded
  Direction direction;
};

struct Batch {
  std::array<Expansion, kBatch> expansions;
  std::array<Offer, kBatch * kDirections> offers;
  std::size_t offer_count{0};
};

TAUTLINE_INLINE void prefetch(const void* p) { __builtin_prefetch(p, 1); }

TAUTLINE_INLINE std::uint16_t gateOf(std::uint32_t label) {
  return static_cast<std::uint16_t>(label >> kGateShift | 1U);
}

/// The offsets, and what else is in the cell's line in the lanes above them.
TAUTLINE_INLINE void load(const CellLabels& c, Lanes16& lanes) {
  std::memcpy(lanes.data(), &c, sizeof c);
}

TAUTLINE_INLINE void prepare(const BucketExpansion& s, const std::array<CellIndex, kRows>& rows,
                             Expansion& x) {
  for (std::size_t r = 0; r < kRows; ++r) {
    const FreeCells::Number n = s.numbers[x.cell + rows[r]];
    x.middle[r] = n.number;
    x.right[r] = n.number + n.free;
    __builtin_prefetch(&s.gates[n.number]);
  }
  x.number = x.middle[kCentreRow];
  prefetch(&s.labels[x.number]);
}

/// Takes the labels to expand now out of the pending ones, drops those that cannot matter, and
/// queues the cell again for the rest. Empty if the cell was queued twice.
TAUTLINE_INLINE std::uint32_t take(const BucketExpansion& s, std::uint32_t bucket, CellIndex cell,
                                   CellLabels& c) {
  const std::uint32_t pending = c.state & CellLabels::kPending;
  if (pending == 0 || c.queued != static_cast<std::uint16_t>(bucket)) return 0;
  alignas(64) Lanes16 offset;
  load(c, offset);
  const std::uint32_t end = (bucket + 1 - c.bucket) << s.units.shift();
  const auto limit = static_cast<std::uint16_t>(std::min<std::uint32_t>(end, CellLabels::kNone));
  const Lanes16& margin = s.units.dominated[at(c.best())];
  std::uint32_t below = 0;
  std::uint32_t alive = std::uint32_t{1} << c.best();
  for (std::size_t d = 0; d < kLanes; ++d) {
    below |= (offset[d] < limit ? 1U : 0U) << d;
    alive |= (offset[d] < static_cast<std::uint16_t>(c.least + margin[d]) ? 1U : 0U) << d;
  }
  const std::uint32_t now = pending & alive & below;
  const std::uint32_t later = pending & alive & ~below;
  c.state = (c.state & ~CellLabels::kPending) | later;
  if (later != 0) {
    std::uint16_t next = CellLabels::kNone;
    for (std::uint32_t rest = later; rest != 0; rest &= rest - 1)
      next = std::min(next, c.offset[static_cast<std::size_t>(std::countr_zero(rest))]);
    const std::uint32_t then = c.bucket + (std::uint32_t{next} >> s.units.shift());
    c.queued = static_cast<std::uint16_t>(then);
    s.queue.push(then, cell);
  }
  return now;
}

/// Cost of leaving in each direction, above the start of the bucket; bits of those that got better
/// by the labels `now`.
TAUTLINE_INLINE std::uint32_t leave(const UnitCosts& units, std::uint32_t bucket,
                                    const CellLabels& c, std::uint32_t now, Lanes32& out) {
  alignas(64) Lanes16 before;
  alignas(64) Lanes16 cost;
  const std::uint32_t start = (bucket - c.bucket) << units.shift();
  if (c.least < start) {  // the least label was expanded already: what it gave
    const Lanes16& turn = units.turn[at(c.best())];
    for (std::size_t e = 0; e < kLanes; ++e)
      before[e] = static_cast<std::uint16_t>(c.least + turn[e]);
  } else {
    before.fill(CellLabels::kNone);
  }
  cost = before;
  for (; now != 0; now &= now - 1) {
    const auto p = static_cast<std::size_t>(std::countr_zero(now));
    const Lanes16& turn = units.turn[p];
    const std::uint16_t label = c.offset[p];
    for (std::size_t e = 0; e < kLanes; ++e)
      cost[e] = std::min(cost[e], static_cast<std::uint16_t>(label + turn[e]));
  }
  std::uint32_t better = 0;
  for (std::size_t e = 0; e < kLanes; ++e) {
    better |= (cost[e] < before[e] ? 1U : 0U) << e;
    out[e] = cost[e] - start;
  }
  return better;
}

TAUTLINE_INLINE void offer(const BucketExpansion& s, const Lanes32& number, CellIndex cell,
                           std::uint32_t mask, const Lanes32& cost, Batch& batch) {
  for (; mask != 0; mask &= mask - 1) {
    const auto e = static_cast<std::size_t>(std::countr_zero(mask));
    const auto d = static_cast<Direction>(e);
    const CellIndex to = s.lattice.neighbour(cell, d);
    prefetch(&s.labels[number[e]]);
    batch.offers[batch.offer_count++] = {to, number[e], cost[e], d};
  }
}

/// Numbers of the neighbours by direction; only those of allowed moves have a meaning.
TAUTLINE_INLINE void spread(const Expansion& x, Lanes32& number) {
  std::size_t lane = 0;
  for (std::size_t r = 0; r < kRows; ++r) {
    number[lane++] = x.middle[r] - 1;
    if (r != kCentreRow) number[lane++] = x.middle[r];
    number[lane++] = x.right[r];
  }
}

TAUTLINE_INLINE bool expand(const BucketExpansion& s, std::uint32_t bucket, const Expansion& x,
                            Batch& batch) {
  CellLabels& c = s.labels[x.number];
  const std::uint32_t now = take(s, bucket, x.cell, c);
  if (now == 0) return false;
  alignas(64) Lanes32 cost;
  std::uint32_t mask = leave(s.units, bucket, c, now, cost) & x.moves;
  if (mask == 0) return true;

  alignas(64) Lanes32 number{};
  spread(x, number);
  alignas(64) Lanes32 locale{};
  alignas(64) Lanes32 least{};
  for (std::size_t d = 0; d < kDirections; ++d) {
    const Gate gate = s.gates[static_cast<std::int32_t>(number[d])];
    locale[d] = gate.locale;
    least[d] = gate.least;
  }
  const std::uint32_t from = s.gates[x.number].locale;
  const std::uint32_t start = bucket << s.units.shift();
  const auto margin = static_cast<int>((s.units.turnMax() >> kGateShift) + 1);
  std::uint32_t open = 0;
  for (std::size_t e = 0; e < kLanes; ++e) {
    const std::uint32_t step = s.units.action[e] + (locale[e] * s.units.locale_in[e] >> 16) +
                               (from * s.units.locale_out[e] >> 16);
    cost[e] += std::max(step, 1U);
    const auto above = static_cast<std::int16_t>(
        static_cast<std::uint16_t>(((start + cost[e]) >> kGateShift) - least[e]));
    const bool passes = (least[e] == 0 || above <= margin) && locale[e] != UnitCosts::kForbidden;
    open |= (passes ? 1U : 0U) << e;
  }
  mask &= open;
  if (s.units.hasAccess()) {
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const auto d = std::countr_zero(rest);
      cost[at(d)] += s.units.access(x.cell, s.lattice.neighbour(x.cell, d));
    }
  }
  offer(s, number, x.cell, mask, cost, batch);
  return true;
}

TAUTLINE_INLINE void accept(const BucketExpansion& s, std::uint32_t bucket, const Offer& o) {
  CellLabels& c = s.labels[o.number];
  const auto e = at(o.direction);
  const int shift = s.units.shift();
  if (!c.reached()) {
    c.bucket = bucket;
    c.state = CellLabels::kReached;
    c.least = CellLabels::kNone;
    c.offset.fill(CellLabels::kNone);
  }
  const std::uint32_t offset = o.cost + ((bucket - c.bucket) << shift);
  if (offset >= c.offset[e]) return;
  if (offset < c.least) {
    c.least = static_cast<std::uint16_t>(offset);
    c.state = (c.state & ~(31U << kDirections)) | static_cast<std::uint32_t>(e) << kDirections;
    s.gates[o.number].least = gateOf((bucket << shift) + o.cost);
  } else if (offset >= std::uint32_t{c.least} + s.units.dominated[at(c.best())][e]) {
    return;
  }
  c.offset[e] = static_cast<std::uint16_t>(offset);
  const std::uint32_t then = bucket + (o.cost >> shift);
  const bool waits = (c.state & CellLabels::kPending) != 0;
  if (!waits || static_cast<std::int16_t>(static_cast<std::uint16_t>(then - c.queued)) < 0) {
    c.queued = static_cast<std::uint16_t>(then);
    s.queue.push(then, o.cell);
  }
  c.state |= std::uint32_t{1} << e;
}

TAUTLINE_INLINE void acceptAll(const BucketExpansion& s, std::uint32_t bucket, Batch& batch) {
  for (std::size_t i = 0; i < batch.offer_count; ++i) accept(s, bucket, batch.offers[i]);
  batch.offer_count = 0;
}

}  // namespace

TAUTLINE_MULTIVERSION std::size_t expandBucket(const BucketExpansion& search,
                                               std::uint32_t bucket) {
  std::array<CellIndex, kRows> rows;
  for (std::size_t r = 0; r < kRows; ++r) {
    rows[r] =
        search.lattice.shape().nx *
        (static_cast<int>(r) % 3 - 1 + search.lattice.shape().ny * (static_cast<int>(r) / 3 - 1));
  }
  Batch batch;
  std::size_t expanded = 0;
  for (std::size_t first = 0; first < search.queue.at(bucket).size();) {
    const std::vector<CellIndex>& cells = search.queue.at(bucket);
    const std::size_t count = std::min(kBatch, cells.size() - first);
    for (std::size_t i = 0; i < count; ++i) {  // by themselves: these loads overlap
      batch.expansions[i].cell = cells[first + i];
      batch.expansions[i].moves = search.lattice.moves(cells[first + i]);
    }
    for (std::size_t i = 0; i < count; ++i) prepare(search, rows, batch.expansions[i]);
    for (std::size_t i = 0; i < count; ++i)
      if (expand(search, bucket, batch.expansions[i], batch)) ++expanded;
    acceptAll(search, bucket, batch);
    first += count;
  }
  return expanded;
}

void expandStart(const BucketExpansion& search, CellIndex start, std::uint32_t start_locale) {
  Batch batch;
  std::uint32_t rest = search.lattice.moves(start);
  for (; rest != 0; rest &= rest - 1) {
    const auto d = std::countr_zero(rest);
    const CellIndex to = search.lattice.neighbour(start, d);
    const std::uint32_t number = search.numbers[to].number;
    const std::uint32_t locale = search.gates[number].locale;
    if (locale == UnitCosts::kForbidden) continue;
    std::uint32_t cost =
        search.units.turn[kNoDirection][at(d)] + search.units.step(d, start_locale, locale);
    if (search.units.hasAccess()) cost += search.units.access(start, to);
    batch.offers[batch.offer_count++] = {to, number, cost, d};
  }
  acceptAll(search, 0, batch);
}

}  // namespace tautline::planning
