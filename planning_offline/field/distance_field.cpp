#include "planning_offline/field/distance_field.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "common/error.h"
#include "planning_offline/simd.h"

namespace tautline::planning {
namespace {

// Squared distances in half cells. The fast type holds up to 86 cells, the wide one 16383. "Far" is
// so much below the type's largest value that far + gap² cannot overflow for any gap looked at.
using Fast = std::uint16_t;
using Wide = std::uint32_t;
template <class T>
constexpr std::uint32_t kFar = std::is_same_v<T, Fast> ? 30000U : 1U << 30U;

constexpr int kLookAtOnce = 4;  // samples to each side between two checks whether to go on

constexpr std::uint32_t squaredGap(int steps) noexcept {
  const auto gap = static_cast<std::uint32_t>(2 * steps - 1);
  return steps == 0 ? 0 : gap * gap;
}

template <class T>
class Transform {
 public:
  Transform(const GridShape& shape, std::span<const std::uint8_t> obstacles,
            const DistanceOptions& options)
      : shape_(shape), obstacles_(obstacles), options_(options), row_stride_(strideOf(shape.nx)) {
    if (options.cap > 0.0) {
      const double cap = std::ceil(std::pow(2.0 * options.cap / options.resolution, 2));
      far_ = static_cast<T>(std::min(cap, static_cast<double>(kFar<T>)));
    }
    while (squaredGap(reach_) < far_) ++reach_;
    squares_ = std::make_unique_for_overwrite<T[]>(shape.size());
    border_x_.resize(stride(), far_);
    for (int x = 0; x < shape.nx; ++x) border_x_[at(x)] = border(x, shape.nx);
  }

  /// False if cancelled.
  bool run(std::vector<float>& distance, const Progress& progress, const Stage& stage) {
    const double middle = 0.5 * (stage.from + stage.to);
    distance.resize(shape_.size());
    return parallelFor(shape_.nz, options_.threads, progress, {stage.what, stage.from, middle},
                       [&](int z) {
                         withWidestVectors([&](auto) TAUTLINE_SIMD_LAMBDA { sweepLayer(z); });
                       }) &&
           parallelFor(shape_.ny, options_.threads, progress, {stage.what, middle, stage.to},
                       [&](int y) {
                         withWidestVectors([&](auto bytes) TAUTLINE_SIMD_LAMBDA {
                           finishSlice<decltype(bytes)::value>(y, distance.data());
                         });
                       });
  }

  /// Some free cell is farther from everything than the type can say and the cap asks for.
  [[nodiscard]] bool saturated() const noexcept { return saturated_; }

 private:
  static int strideOf(int nx) noexcept { return (nx + 63) / 64 * 64; }
  static std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t stride() const noexcept { return at(row_stride_); }
  [[nodiscard]] std::size_t rowAt(int y, int z) const noexcept {
    return (at(z) * at(shape_.ny) + at(y)) * at(shape_.nx);
  }
  /// Squared distance to the outside along an axis of n cells.
  [[nodiscard]] T border(int i, int n) const noexcept {
    if (!options_.solid_border) return far_;
    const int steps = std::min({i + 1, n - i, reach_});
    return static_cast<T>(std::min<std::uint32_t>(squaredGap(steps), far_));
  }

  /// Along y, all x at once: the way to the nearest obstacle of the same x and z.
  TAUTLINE_INLINE void sweepLayer(int z) {
    const std::size_t nx = at(shape_.nx);
    const auto reach = static_cast<T>(reach_);
    std::vector<T> steps(nx, reach);
    for (int y = 0; y < shape_.ny; ++y) {
      const std::uint8_t* __restrict obstacle = &obstacles_[rowAt(y, z)];
      T* __restrict out = &squares_[rowAt(y, z)];
      T* __restrict way = steps.data();
      for (std::size_t x = 0; x < nx; ++x) {
        const T next = static_cast<T>(way[x] + 1);
        way[x] = obstacle[x] != 0 ? T{0} : (next < reach ? next : reach);
        out[x] = way[x];
      }
    }
    std::fill(steps.begin(), steps.end(), reach);
    for (int y = shape_.ny - 1; y >= 0; --y) {
      T* __restrict out = &squares_[rowAt(y, z)];
      T* __restrict way = steps.data();
      for (std::size_t x = 0; x < nx; ++x) {
        const T next = static_cast<T>(way[x] + 1);
        way[x] = next < out[x] ? next : out[x];
        const T gap = static_cast<T>(2 * way[x] - (way[x] > 0 ? 1 : 0));
        const T square = static_cast<T>(gap * gap);
        out[x] = square < far_ ? square : far_;
      }
    }
  }

  /// Along z and then along x, of all cells with the same y.
  template <int kBytes>
  TAUTLINE_INLINE void finishSlice(int y, float* distance) {
    const std::size_t nx = at(shape_.nx);
    std::vector<T> slice(at(shape_.nz) * stride(), far_);
    for (int z = 0; z < shape_.nz; ++z) {
      std::copy_n(&squares_[rowAt(y, z)], nx, &slice[at(z) * stride()]);
    }
    std::vector<T> row(3 * stride(), far_);  // so that looking past its ends finds "far"
    std::vector<T> result(stride());
    T* const first = &row[stride()];
    const T border_y = shape_.planar() ? far_ : border(y, shape_.ny);
    constexpr int kLanes = kBytes / static_cast<int>(sizeof(T));
    for (int z = 0; z < shape_.nz; ++z) {
      for (int x = 0; x < shape_.nx; x += kLanes) {
        lookAround<kBytes>(&slice[at(z) * stride() + at(x)], row_stride_, z, shape_.nz - 1 - z,
                           first + x);
      }
      for (int x = 0; x < shape_.nx; x += kLanes) {
        lookAround<kBytes>(first + x, 1, row_stride_, row_stride_, &result[at(x)]);
      }
      writeRow(result.data(), std::min(border_y, border(z, shape_.nz)), distance + rowAt(y, z));
    }
  }

  /// Smallest of samples + squared gap, for a vector of cells: `before` samples lie before the
  /// centre, `after` behind it, `stride` apart.
  template <int kBytes>
  TAUTLINE_INLINE static void lookAround(const T* centre, std::ptrdiff_t stride, int before,
                                         int after, T* out) {
    using Vector = Simd<T, kBytes>;
    Vector best;
    simdLoad(centre, best);
    const int farthest = std::max(before, after);
    for (int k = 1; k <= farthest; ++k) {
      const auto cost = static_cast<T>(squaredGap(k));
      if (k % kLookAtOnce == 1 && !simdAny(best > cost)) break;
      Vector other;
      if (k <= before) {
        simdLoad(centre - k * stride, other);
        other += cost;
        best = other < best ? other : best;
      }
      if (k <= after) {
        simdLoad(centre + k * stride, other);
        other += cost;
        best = other < best ? other : best;
      }
    }
    simdStore(best, out);
  }

  TAUTLINE_INLINE void writeRow(const T* __restrict square, T border_yz, float* __restrict out) {
    const T* __restrict border_x = border_x_.data();
    const auto half = static_cast<float>(0.5 * options_.resolution);
    const bool capped = options_.cap > 0.0;
    const float largest =
        capped ? static_cast<float>(options_.cap) : std::numeric_limits<float>::infinity();
    T farthest = 0;
    for (std::size_t x = 0; x < at(shape_.nx); ++x) {
      const T border = border_x[x] < border_yz ? border_x[x] : border_yz;
      const T nearest = square[x] < border ? square[x] : border;
      farthest = nearest > farthest ? nearest : farthest;
      const float metres = half * std::sqrt(static_cast<float>(nearest));
      out[x] = metres < largest ? metres : largest;
    }
    // Only here may "far" stand for less than the cap.
    if (farthest == kFar<T>) saturated_.store(true, std::memory_order_relaxed);
  }

  GridShape shape_;
  std::span<const std::uint8_t> obstacles_;
  DistanceOptions options_;
  int row_stride_;  // of rows in buffers: whole vectors
  T far_{kFar<T>};  // nothing beyond this is told apart
  int reach_{1};    // cells after which the gap alone is far
  std::unique_ptr<T[]> squares_;
  std::vector<T> border_x_;
  std::atomic<bool> saturated_{false};
};

}  // namespace

std::vector<float> distanceField(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                                 const DistanceOptions& options, const Progress& progress,
                                 const Stage& stage) {
  TAUTLINE_CHECK(obstacles.size() == shape.size() && options.resolution > 0.0);
  std::vector<float> distance;
  Transform<Fast> fast(shape, obstacles, options);
  if (!fast.run(distance, progress, stage)) return {};
  if (!fast.saturated()) return distance;
  Transform<Wide> wide(shape, obstacles, options);
  if (!wide.run(distance, progress, stage)) return {};
  if (wide.saturated()) {
    const double diagonal =
        options.resolution * Eigen::Vector3d(shape.nx, shape.ny, shape.nz).norm();
    for (float& d : distance) d = std::min(d, static_cast<float>(diagonal));
  }
  return distance;
}

}  // namespace tautline::planning
