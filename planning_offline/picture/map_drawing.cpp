#include "planning_offline/picture/map_drawing.h"

#include <array>
#include <utility>

namespace tautline::planning {
namespace {

/// Cells lo … hi on each axis, both included.
struct CellBox {
  Eigen::Vector3i lo;
  Eigen::Vector3i hi;
};

/// Map axes along the picture's x and y, and into it.
struct ViewAxes {
  int right;
  int up;
  int depth;
};
constexpr std::array<ViewAxes, 3> kViewAxes{{{0, 2, 1}, {0, 1, 2}, {2, 1, 0}}};  // top, front, side

CellBox boxOf(const VoxelMap& map, const std::vector<Eigen::Vector3d>& points) {
  constexpr int kMargin = 2;
  const Eigen::Vector3i last(map.shape.nx - 1, map.shape.ny - 1, map.shape.nz - 1);
  CellBox box{last, Eigen::Vector3i::Zero()};
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3i cell = map.cellAt(point);
    box.lo = box.lo.cwiseMin(cell);
    box.hi = box.hi.cwiseMax(cell);
  }
  if ((box.lo.array() > box.hi.array()).any()) return {Eigen::Vector3i::Zero(), last};
  box.lo = (box.lo.array() - kMargin).max(0);
  box.hi = (box.hi.array() + kMargin).min(last.array());
  return box;
}

/// The whole map seen along one axis, of its depth only the slab of the box.
plot::Raster obstacleImage(const VoxelMap& map, const ViewAxes& axes, const CellBox& box) {
  const std::array<int, 3> sizes{map.shape.nx, map.shape.ny, map.shape.nz};
  plot::Raster image{.x_min = map.origin[axes.right],
                     .y_min = map.origin[axes.up],
                     .pixel_width = map.resolution,
                     .pixel_height = map.resolution,
                     .columns = sizes[static_cast<std::size_t>(axes.right)],
                     .rows = sizes[static_cast<std::size_t>(axes.up)]};
  image.pixels.reserve(static_cast<std::size_t>(image.columns) *
                       static_cast<std::size_t>(image.rows));
  const double depth = box.hi[axes.depth] - box.lo[axes.depth] + 1;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      Eigen::Vector3i cell;
      cell[axes.right] = column;
      cell[axes.up] = row;
      int occupied = 0;
      int unknown = 0;
      for (int d = box.lo[axes.depth]; d <= box.hi[axes.depth]; ++d) {
        cell[axes.depth] = d;
        const CellState state = map.cells[static_cast<std::size_t>(map.shape.index(cell))];
        occupied += state == CellState::kOccupied ? 1 : 0;
        unknown += state == CellState::kUnknown ? 1 : 0;
      }
      if (occupied > 0) {
        image.pixels.push_back(plot::grey(0.85 - 0.5 * occupied / depth));
      } else {
        image.pixels.push_back(unknown == static_cast<int>(depth) ? plot::Rgb{238, 233, 245}
                                                                  : plot::grey(1.0));
      }
    }
  }
  return image;
}

}  // namespace

plot::Drawing mapDrawing(const std::string& title, const VoxelMap& map,
                         const std::vector<Eigen::Vector3d>& points) {
  plot::Drawing drawing;
  drawing.title = title;
  const CellBox box = boxOf(map, points);
  for (std::size_t view = 0; view < kViewAxes.size(); ++view)
    drawing.images[view] = obstacleImage(map, kViewAxes[view], box);
  return drawing;
}

plot::Figure mapFigure(const VoxelMap& map, const plot::Drawing& drawing) {
  return map.shape.planar() ? viewFigure(drawing, plot::View::kTop) : viewsFigure(drawing);
}

}  // namespace tautline::planning
