#include "planning_offline/tether/near_field.h"

#include "common/error.h"

namespace tautline::planning {
namespace {

/// Lowers each of `out` to 1 more than the least of the cells beside it in `row`.
void lower(const std::uint8_t* row, std::uint8_t* out, std::ptrdiff_t cells) {
  const auto more = [](std::uint8_t d) {
    return static_cast<std::uint8_t>(d + (d < NearField::kFarthest ? 1 : 0));
  };
  const auto one = [&](std::ptrdiff_t x, std::ptrdiff_t from, std::ptrdiff_t to) {
    for (std::ptrdiff_t k = from; k <= to; ++k) out[x] = std::min(out[x], more(row[k]));
  };
  one(0, 0, std::min<std::ptrdiff_t>(1, cells - 1));
  for (std::ptrdiff_t x = 1; x + 1 < cells; ++x) {
    out[x] = std::min(out[x], more(std::min({row[x - 1], row[x], row[x + 1]})));
  }
  if (cells > 1) one(cells - 1, cells - 2, cells - 1);
}

/// One pass of the chessboard distance transform (Rosenfeld and Pfaltz, 1966), in the order of the
/// cells or against it.
void sweep(const GridShape& shape, std::vector<std::uint8_t>& cells, bool forward) {
  const auto row = [&](int y, int z) {
    return cells.data() + static_cast<std::ptrdiff_t>(shape.index({0, y, z}));
  };
  const int step = forward ? 1 : -1;
  for (int k = 0; k < shape.nz; ++k) {
    const int z = forward ? k : shape.nz - 1 - k;
    for (int j = 0; j < shape.ny; ++j) {
      const int y = forward ? j : shape.ny - 1 - j;
      std::uint8_t* out = row(y, z);
      if (k > 0) {
        for (int dy = -1; dy <= 1; ++dy) {
          if (y + dy >= 0 && y + dy < shape.ny) lower(row(y + dy, z - step), out, shape.nx);
        }
      }
      if (j > 0) lower(row(y - step, z), out, shape.nx);
      int last = NearField::kFarthest;
      for (int i = 0; i < shape.nx; ++i) {
        std::uint8_t& cell = out[forward ? i : shape.nx - 1 - i];
        last = std::min<int>(cell, last + 1);
        cell = static_cast<std::uint8_t>(last);
      }
    }
  }
}

/// Cells to the nearest marked one.
std::vector<std::uint8_t> chessboardDistance(const GridShape& shape,
                                             const std::vector<std::uint8_t>& marked) {
  TAUTLINE_CHECK(marked.size() == shape.size() && !marked.empty());
  std::vector<std::uint8_t> cells(marked.size(), NearField::kFarthest);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (marked[i] != 0) cells[i] = 0;
  }
  sweep(shape, cells, true);
  sweep(shape, cells, false);
  return cells;
}

}  // namespace

NearField::NearField(const GridShape& shape, const std::vector<std::uint8_t>& touching_edges,
                     const std::vector<std::uint8_t>& touching_occupied)
    : shape_(shape), cells_(shape.size()) {
  const std::vector<std::uint8_t> edges = chessboardDistance(shape, touching_edges);
  const std::vector<std::uint8_t> occupied = chessboardDistance(shape, touching_occupied);
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i] = {edges[i], occupied[i]};
}

NearField::Near NearField::near(const Eigen::Vector3d& c, const Eigen::Vector3d& p,
                                const Eigen::Vector3d& q) const noexcept {
  constexpr double kStep = 1.0;   // where something is near
  constexpr double kLeast = 0.4;  // of a step where nothing is, to pay
  Near out;
  // At a part t of its length the string is within t · half of the point t of its middle position.
  const Eigen::Vector3d along = 0.5 * (p + q) - c;
  const double half = 0.5 * (q - p).lpNorm<Eigen::Infinity>();
  const double length = along.lpNorm<Eigen::Infinity>();
  if (!(length > kStep)) {
    out.edges.add(0.0, 1.0);
    out.occupied.add(0.0, 1.0);
    return out;
  }
  const double per_cell = 1.0 / length;
  for (double t = 1.0; t > 0.0;) {
    const Distance d = distance(c + t * along);
    const double used = t * half + kMargin;
    const double room = d.occupied - used;
    if (room >= kLeast) {  // edges are no nearer
      t -= room * per_cell;
      continue;
    }
    const double low = std::max(t - kStep * per_cell, 0.0);
    out.occupied.add(low, t);
    if (d.edges - used < kStep) out.edges.add(low, t);
    t = low;
  }
  return out;
}

}  // namespace tautline::planning
