#include "planning_offline/field/isovist.h"

#include <algorithm>
#include <array>
#include <memory>

#include "common/error.h"
#include "planning_offline/simd.h"

namespace tautline::planning {
namespace {

using Word = std::uint64_t;
constexpr int kWordShift = 6;
constexpr int kWordBits = 1 << kWordShift;
constexpr int kWidest = 8;         // words of the widest vector
constexpr int kLengthPlanes = 16;  // bits of kIsovistUnits
constexpr int kSumPlanes = 32;     // bits of the sum over at most 2^16 directions

std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

/// Free cells, one bit each. A word holds 64 cells along x; words follow each other along the
/// longer other axis ("lane"), so that one vector of words is a patch of the map that a step shifts
/// as a whole. All around lies a margin that is not free.
struct BitMap {
  BitMap(const GridShape& shape, std::span<const std::uint8_t> obstacles)
      : lane_is_z(shape.nz > shape.ny),
        lanes(lane_is_z ? shape.nz : shape.ny),
        layers(lane_is_z ? shape.ny : shape.nz),
        columns((shape.nx + kWordBits - 1) / kWordBits),
        padded_lanes((lanes + kWidest - 1) / kWidest * kWidest),
        words(at(layers) * at(columns) * at(columnSize()), 0),
        nothing(at(columnSize()), 0) {
    for (int z = 0; z < shape.nz; ++z) {
      for (int y = 0; y < shape.ny; ++y) {
        const std::uint8_t* row = &obstacles[at(shape.index({0, y, z}))];
        for (int x = 0; x < shape.nx; ++x) {
          Word& word = *word_at(lane_is_z ? y : z, x / kWordBits, lane_is_z ? z : y);
          word |= Word{row[x] == 0} << (x % kWordBits);
        }
      }
    }
  }

  [[nodiscard]] int columnSize() const noexcept { return padded_lanes + 2 * kWidest; }
  [[nodiscard]] Word* word_at(int layer, int column, int lane) noexcept {
    return &words[at((layer * columns + column) * columnSize() + kWidest + lane)];
  }
  /// Words of a column from lane 0 on; of one beside the map, all zero.
  [[nodiscard]] const Word* column(int layer, int c) const noexcept {
    const bool inside = c >= 0 && c < columns;
    return kWidest + (inside ? &words[at((layer * columns + c) * columnSize())] : nothing.data());
  }

  bool lane_is_z;
  int lanes;
  int layers;
  int columns;
  int padded_lanes;
  std::vector<Word> words;
  std::vector<Word> nothing;
};

/// What happens to a patch in one step of a direction.
struct PatchStep {
  int layer;
  int column;
  int lane;
  int shift;                               // bits, 0 … 63
  std::array<Word, kLengthPlanes> length;  // bits of the length where the step ends, all or none
};

std::array<Word, kLengthPlanes> planesOf(std::uint32_t length) {
  std::array<Word, kLengthPlanes> planes;
  for (int b = 0; b < kLengthPlanes; ++b) planes[at(b)] = Word{0} - ((length >> b) & 1U);
  return planes;
}

class Isovist {
 public:
  Isovist(const GridShape& shape, std::span<const std::uint8_t> obstacles,
          const IsovistOptions& options)
      : shape_(shape), map_(shape, obstacles) {
    const int wanted = options.directions > 0 ? options.directions
                       : shape.planar()       ? kIsovistDirectionsPlanar
                                              : kIsovistDirections;
    const double cap = options.cap / options.resolution;
    // Whatever the cap, a ray has left the map after its diagonal.
    const double length = std::min(cap, Eigen::Vector3d(shape.nx, shape.ny, shape.nz).norm() + 1.0);
    for (const Eigen::Vector3d& direction : isovistDirections(wanted, shape.planar())) {
      std::vector<PatchStep>& steps = directions_.emplace_back();
      for (const RayStep& step : raySteps(direction, length)) {
        const Eigen::Vector3i& o = step.offset;
        steps.push_back({.layer = map_.lane_is_z ? o.y() : o.z(),
                         .column = o.x() >> kWordShift,
                         .lane = map_.lane_is_z ? o.z() : o.y(),
                         .shift = o.x() & (kWordBits - 1),
                         .length = planesOf(isovistUnits(step.length, cap))});
      }
    }
    scale_ = options.cap /
             (static_cast<double>(kIsovistUnits) * static_cast<double>(directions_.size()));
  }

  [[nodiscard]] int layers() const noexcept { return map_.layers; }

  template <int kBytes>
  TAUTLINE_INLINE void computeLayer(int layer, float* visibility) const {
    constexpr int kWords = kBytes / static_cast<int>(sizeof(Word));
    const int patches = (map_.lanes + kWords - 1) / kWords;
    const std::size_t sums_size = at(patches * map_.columns) * kSumPlanes * kWords;
    const auto sums = std::make_unique<Word[]>(sums_size);
    for (const std::vector<PatchStep>& steps : directions_) {
      Word* sum = sums.get();
      for (int column = 0; column < map_.columns; ++column) {
        for (int p = 0; p < patches; ++p, sum += kSumPlanes * kWords) {
          addDirection<kBytes>(layer, column, p * kWords, steps, sum);
        }
      }
    }
    writeLayer(layer, kWords, sums.get(), visibility);
  }

 private:
  /// Adds the lengths of one direction's rays from the cells of a patch to their sums.
  template <int kBytes>
  TAUTLINE_INLINE void addDirection(int layer, int column, int lane,
                                    const std::vector<PatchStep>& steps, Word* sum) const {
    using Patch = Simd<Word, kBytes>;
    Patch alive;  // rays that are still free
    simdLoad(map_.column(layer, column) + lane, alive);
    if (!simdAny(alive)) return;
    Patch length[kLengthPlanes] = {};
    for (const PatchStep& step : steps) {
      Patch free;
      patchAt(layer + step.layer, column + step.column, lane + step.lane, step.shift, free);
      const Patch ended = alive & ~free;
      for (int b = 0; b < kLengthPlanes; ++b) length[b] |= ended & step.length[at(b)];
      alive &= free;
      if (!simdAny(alive)) break;
    }
    Patch carry = {};
    for (int b = 0; b < kSumPlanes; ++b) {
      Patch old;
      simdLoad(sum, old);
      const Patch added = b < kLengthPlanes ? length[b] | alive : Patch{};
      const Patch either = old ^ added;
      const Patch now = either ^ carry;
      simdStore(now, sum);
      carry = (old & added) | (either & carry);
      sum += sizeof(Patch) / sizeof(Word);
      if (b >= kLengthPlanes && !simdAny(carry)) break;
    }
  }

  /// The free cells of a patch, also where it lies partly or wholly outside the map.
  template <class Patch>
  TAUTLINE_INLINE void patchAt(int layer, int column, int lane, int shift, Patch& free) const {
    if (layer < 0 || layer >= map_.layers) {
      free = Patch{};
      return;
    }
    const int within = std::clamp(lane, -kWidest, map_.padded_lanes);
    Patch upper;
    simdLoad(map_.column(layer, column) + within, free);
    simdLoad(map_.column(layer, column + 1) + within, upper);
    free = (free >> shift) | ((upper << 1) << (kWordBits - 1 - shift));
  }

  /// From bit planes to metres.
  TAUTLINE_INLINE void writeLayer(int layer, int words, const Word* sums, float* visibility) const {
    const int patches = (map_.lanes + words - 1) / words;
    for (int column = 0; column < map_.columns; ++column) {
      const int x0 = column * kWordBits;
      const int width = std::min(kWordBits, shape_.nx - x0);
      for (int lane = 0; lane < map_.lanes; ++lane) {
        const Word* planes =
            sums + at(column * patches + lane / words) * kSumPlanes * at(words) + lane % words;
        std::array<std::uint32_t, kWordBits> sum{};
        for (int b = 0; b < kSumPlanes; ++b) {
          const Word plane = planes[b * words];
          if (plane == 0) continue;
          for (int i = 0; i < kWordBits; ++i) {
            sum[at(i)] |= static_cast<std::uint32_t>((plane >> i) & 1U) << b;
          }
        }
        const Eigen::Vector3i first =
            map_.lane_is_z ? Eigen::Vector3i(x0, layer, lane) : Eigen::Vector3i(x0, lane, layer);
        float* out = visibility + shape_.index(first);
        for (int i = 0; i < width; ++i) out[i] = static_cast<float>(scale_ * sum[at(i)]);
      }
    }
  }

  GridShape shape_;
  BitMap map_;
  std::vector<std::vector<PatchStep>> directions_;
  double scale_;  // metres a unit of a sum
};

}  // namespace

std::vector<float> isovistField(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                                const IsovistOptions& options, const Progress& progress,
                                const Stage& stage) {
  TAUTLINE_CHECK(obstacles.size() == shape.size() && options.cap > 0.0 &&
                 options.resolution > 0.0 && options.directions <= kIsovistUnits + 1);
  const Isovist isovist(shape, obstacles, options);
  std::vector<float> visibility(shape.size());
  const bool complete =
      parallelFor(isovist.layers(), options.threads, progress, stage, [&](int layer) {
        withWidestVectors([&](auto bytes) TAUTLINE_SIMD_LAMBDA {
          isovist.computeLayer<decltype(bytes)::value>(layer, visibility.data());
        });
      });
  return complete ? visibility : std::vector<float>{};
}

}  // namespace tautline::planning
