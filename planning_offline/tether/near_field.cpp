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

}  // namespace

NearField::NearField(const GridShape& shape, const std::vector<std::uint8_t>& touching)
    : shape_(shape), cells_(touching.size(), kFarthest) {
  TAUTLINE_CHECK(touching.size() == shape.size() && !touching.empty());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (touching[i] != 0) cells_[i] = 0;
  }
  sweep(shape_, cells_, true);
  sweep(shape_, cells_, false);
}

Stretches NearField::near(const Eigen::Vector3d& c, const Eigen::Vector3d& p,
                          const Eigen::Vector3d& q) const noexcept {
  constexpr double kLeast = 0.5;  // of a step that pays
  Stretches out;
  // At a part t of its length the string is within t · half of the point t of its middle position.
  const Eigen::Vector3d along = 0.5 * (p + q) - c;
  const double half = 0.5 * (q - p).lpNorm<Eigen::Infinity>();
  const double length = along.lpNorm<Eigen::Infinity>();
  double t = 1.0;
  while (t > 0.0) {
    const double room = distance(c + t * along) - t * half - kMargin;
    const double clear = t - room / length;
    if (room >= kLeast && clear < t) {
      t = clear;
    } else {
      const double low = length > 0.0 ? std::max(t - kLeast / length, 0.0) : 0.0;
      out.add(low < t ? low : 0.0, t);
      t = low < t ? low : 0.0;
    }
  }
  return out;
}

}  // namespace tautline::planning
