#include "planning_offline/map/movingai.h"

#include <array>
#include <optional>

#include "common/error.h"
#include "planning_offline/map/line_reader.h"
#include "planning_offline/map/raster.h"

namespace tautline::planning {
namespace {

constexpr std::string_view kPassable = ".G";
constexpr std::string_view kBlocked = "@OTSW";

/// All cells free; `size` in cells.
VoxelMap emptyMap(const LineReader& lines, const Eigen::Vector3i& size,
                  const LoadOptions& options) {
  const double resolution = options.resolution.value_or(1.0);
  return makeMap({.file = lines.file(),
                  .extent = {Eigen::Vector3d::Zero(), resolution * size.cast<double>()},
                  .resolution = resolution,
                  .resampled = false},
                 options);
}

void block(VoxelMap& map, const Eigen::Vector3i& cell) {
  const Eigen::Vector3d lo = map.resolution * cell.cast<double>();
  mark(map, {lo, lo + Eigen::Vector3d::Constant(map.resolution)}, CellState::kOccupied);
}

struct PlaneSize {
  int height{0};
  int width{0};
};

/// Reads up to and with the line `map`.
PlaneSize readPlaneHeader(LineReader& lines) {
  PlaneSize size;
  while (lines.nextNotBlank()) {
    const std::vector<std::string_view> words = lines.words();
    if (words.size() == 1 && words[0] == "map") {
      if (size.height == 0 || size.width == 0)
        throw lines.error("'map' before both height and width were given");
      return size;
    }
    if (words.size() == 2 && words[0] == "type") {
      if (words[1] != "octile")
        throw lines.error("type " + shownText(words[1]) + " is not known", "octile");
      continue;
    }
    const bool height = words[0] == "height";
    if (words.size() != 2 || !(height || words[0] == "width"))
      throw lines.error("is " + shownText(lines.line()), "type octile, height N, width N, map");
    const std::optional<int> value = integerOf(words[1]);
    if (!value || *value < 1)
      throw lines.error(std::string(words[0]) + " is " + shownText(words[1]), "an integer above 0");
    (height ? size.height : size.width) = *value;
  }
  throw lines.error("the file ends within its header", "", "it is truncated; get it again");
}

void readRow(const LineReader& lines, int row, int width, VoxelMap& map) {
  const std::string_view line = lines.line();
  if (line.size() != static_cast<std::size_t>(width)) {
    throw lines.error(
        "row " + std::to_string(row) + " has " + std::to_string(line.size()) + " cells",
        std::to_string(width) + ", the width");
  }
  for (int column = 0; column < width; ++column) {
    const char c = line[static_cast<std::size_t>(column)];
    if (kPassable.find(c) != std::string_view::npos) continue;
    if (kBlocked.find(c) == std::string_view::npos) {
      throw lines.error(
          "column " + std::to_string(column) + " of the map is " +
              shownText(std::string_view(&c, 1)),
          std::string(kPassable) + " (passable) or " + std::string(kBlocked) + " (blocked)");
    }
    block(map, {column, 0, row});
  }
}

Eigen::Vector3i readSpaceHeader(LineReader& lines) {
  lines.next();
  const std::vector<std::string_view> words = lines.words();
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  for (std::size_t i = 0; i < 3 && words.size() == 4; ++i) {
    size[static_cast<int>(i)] = integerOf(words[i + 1]).value_or(0);
  }
  if (size.minCoeff() < 1)
    throw lines.error("is " + shownText(lines.line()), "voxel W H D, integers above 0");
  return size;
}

Eigen::Vector3i readVoxel(const LineReader& lines, const Eigen::Vector3i& size) {
  const std::vector<std::string_view> words = lines.words();
  std::array<std::optional<int>, 3> voxel;
  for (std::size_t i = 0; i < 3 && words.size() == 3; ++i) voxel[i] = integerOf(words[i]);
  if (!voxel[0] || !voxel[1] || !voxel[2])
    throw lines.error("is " + shownText(lines.line()), "x y z of an occupied voxel, integers");
  Eigen::Vector3i cell(*voxel[0], *voxel[1], *voxel[2]);
  if (cell.minCoeff() < 0 || (cell.array() >= size.array()).any()) {
    throw lines.error("voxel " + std::string(lines.line()) + " is outside the map",
                      "0 0 0 to " + std::to_string(size.x() - 1) + " " +
                          std::to_string(size.y() - 1) + " " + std::to_string(size.z() - 1));
  }
  return cell;
}

}  // namespace

VoxelMap movingAiPlane(std::string_view text, const std::string& file, const LoadOptions& options) {
  LineReader lines(file, text);
  const PlaneSize size = readPlaneHeader(lines);
  VoxelMap map = emptyMap(lines, {size.width, 1, size.height}, options);
  for (int row = 0; row < size.height; ++row) {
    if (!lines.next()) {
      throw lines.error("the file ends after " + std::to_string(row) + " rows",
                        std::to_string(size.height) + ", the height",
                        "it is truncated; get it again");
    }
    readRow(lines, row, size.width, map);
  }
  if (lines.nextNotBlank())
    throw lines.error("there are more rows than " + std::to_string(size.height) + ", the height");
  return map;
}

VoxelMap movingAiSpace(std::string_view text, const std::string& file, const LoadOptions& options) {
  LineReader lines(file, text);
  const Eigen::Vector3i size = readSpaceHeader(lines);
  VoxelMap map = emptyMap(lines, size, options);
  while (lines.nextNotBlank()) block(map, readVoxel(lines, size));
  return map;
}

}  // namespace tautline::planning
