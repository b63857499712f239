#include "planning_offline/field/benchmark/distance_reference.h"

#include <dynamicEDT3D/dynamicEDT3D.h>

#include <chrono>

namespace tautline::planning {

double dynamicEdtSeconds(const GridShape& shape, std::span<const std::uint8_t> obstacles,
                         int reach) {
  const auto nx = static_cast<std::size_t>(shape.nx);
  const auto ny = static_cast<std::size_t>(shape.ny);
  const auto nz = static_cast<std::size_t>(shape.nz);
  auto*** grid = new bool**[nx];  // DynamicEDT3D takes it over
  for (std::size_t x = 0; x < nx; ++x) {
    grid[x] = new bool*[ny];
    for (std::size_t y = 0; y < ny; ++y) {
      grid[x][y] = new bool[nz];
      for (std::size_t z = 0; z < nz; ++z) grid[x][y][z] = obstacles[(z * ny + y) * nx + x] != 0;
    }
  }
  DynamicEDT3D edt(reach * reach);
  edt.initializeMap(shape.nx, shape.ny, shape.nz, grid);
  const auto start = std::chrono::steady_clock::now();
  edt.update(true);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tautline::planning
