#include "planning_offline/field/passage_width.h"

#include <algorithm>

#include "common/error.h"
#include "planning_offline/map/lattice.h"

namespace tautline::planning {
namespace {

enum class Place : std::uint8_t { kFree, kWall, kOpen };

/// The map with one more cell on all sides: what a chord that leaves it meets.
class Padded {
 public:
  Padded(const GridShape& shape, std::span<const std::uint8_t> obstacles, bool solid_border)
      : shape_{shape.nx + 2, shape.ny + 2, shape.nz + 2},
        places_(shape_.size(), solid_border ? Place::kWall : Place::kOpen) {
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const Eigen::Vector3i cell = shape.cell(static_cast<CellIndex>(i));
      if (obstacles[i] == 0) places_[at(cell)] = Place::kFree;
      if (obstacles[i] != 0) places_[at(cell)] = Place::kWall;
    }
  }
  /// Place of a cell of the map.
  [[nodiscard]] std::size_t at(const Eigen::Vector3i& cell) const noexcept {
    return static_cast<std::size_t>(shape_.index((cell.array() + 1).matrix()));
  }
  [[nodiscard]] std::ptrdiff_t offset(const Eigen::Vector3i& step) const noexcept {
    return (step.z() * shape_.ny + step.y()) * shape_.nx + step.x();
  }
  [[nodiscard]] const Place* data() const noexcept { return places_.data(); }

 private:
  GridShape shape_;
  std::vector<Place> places_;
};

}  // namespace

std::vector<float> widthField(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                              const WidthOptions& options, const Progress& progress,
                              const Stage& stage) {
  TAUTLINE_CHECK(obstacles.size() == shape.size() && options.resolution > 0.0);
  const Padded padded(shape, obstacles, options.solid_border);
  const auto cap = static_cast<float>(options.cap);
  std::vector<float> width(shape.size());
  std::transform(obstacles.begin(), obstacles.end(), width.begin(),
                 [cap](std::uint8_t obstacle) { return obstacle != 0 ? 0.0F : cap; });

  std::vector<Direction> lines = directionsOf(Connectivity::kVertices, shape.planar());
  std::erase_if(lines, [](Direction d) { return d > opposite(d); });
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const Eigen::Vector3i& step = stepOf(lines[n]);
    const std::ptrdiff_t padded_step = padded.offset(step);
    const std::ptrdiff_t cell_step = shape.index(step);  // an offset: linear in its argument
    const double step_length = options.resolution * stepLength(lines[n]);
    // Each chord belongs to the cell that it starts in, so no two threads write the same cell.
    const auto walkLayer = [&](int z) {
      for (int y = 0; y < shape.ny; ++y) {
        const Place* place = padded.data() + padded.at({0, y, z});
        float* out = &width[static_cast<std::size_t>(shape.index({0, y, z}))];
        for (int x = 0; x < shape.nx; ++x, ++place, ++out) {
          if (*place != Place::kFree || *(place - padded_step) == Place::kFree) continue;
          std::ptrdiff_t cells = 1;
          while (place[cells * padded_step] == Place::kFree) ++cells;
          const bool open =
              *(place - padded_step) == Place::kOpen || place[cells * padded_step] == Place::kOpen;
          const auto chord = static_cast<float>(static_cast<double>(cells) * step_length);
          if (open || chord >= cap) continue;
          for (std::ptrdiff_t i = 0; i < cells; ++i) {
            float& narrowest = out[i * cell_step];
            narrowest = std::min(narrowest, chord);
          }
        }
      }
    };
    const double share = (stage.to - stage.from) / static_cast<double>(lines.size());
    const double from = stage.from + share * static_cast<double>(n);
    if (!parallelFor(shape.nz, options.threads, progress, {stage.what, from, from + share},
                     walkLayer)) {
      return {};
    }
  }
  return width;
}

}  // namespace tautline::planning
