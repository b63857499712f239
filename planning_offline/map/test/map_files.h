#pragma once

/// @file
/// Map files for tests: written to a folder that goes with the test, or the real ones.

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "common/mission/test/test_problem.h"
#include "planning_offline/map/load_map.h"

namespace tautline::planning {

/// A folder of its own for each object.
class MapFolder {
 public:
  MapFolder() {
    static int count = 0;
    folder_ = std::filesystem::temp_directory_path() /
              ("tautline_map_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(folder_);
  }
  MapFolder(const MapFolder&) = delete;
  MapFolder& operator=(const MapFolder&) = delete;
  ~MapFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return folder_ / name;
  }

  [[nodiscard]] VoxelMap load(const std::string& name, std::string_view bytes,
                              const LoadOptions& options = {}) const {
    return loadMap(write(name, bytes), options);
  }

  [[nodiscard]] InputProblem problem(const std::string& name, std::string_view bytes,
                                     const LoadOptions& options = {}) const {
    const std::filesystem::path path = write(name, bytes);
    InputProblem problem = problemOf([&] { (void)loadMap(path, options); }, name);
    EXPECT_EQ(describe(problem).find('\n'), std::string::npos) << describe(problem);
    return problem;
  }

 private:
  std::filesystem::path folder_;
};

inline std::filesystem::path realData() {
  const char* given = std::getenv("TAUTLINE_DATA");
  return given != nullptr ? given : TAUTLINE_SOURCE_DIR "/../shared/data";
}

inline std::size_t countOf(const VoxelMap& map, CellState state) {
  std::size_t count = 0;
  for (const CellState s : map.cells) count += s == state ? 1U : 0U;
  return count;
}

/// One letter a cell, '.' free, '#' occupied, '?' unknown; rows along z, layers along y apart.
inline std::string picture(const VoxelMap& map) {
  std::string text;
  for (int y = 0; y < map.shape.ny; ++y) {
    if (y > 0) text += "\n";
    for (int z = 0; z < map.shape.nz; ++z) {
      for (int x = 0; x < map.shape.nx; ++x) {
        text += ".#?"[static_cast<int>(
            map.cells[static_cast<std::size_t>(map.shape.index({x, y, z}))])];
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace tautline::planning
