#pragma once

/// @file
/// Pictures of a grid of values. Not real-time safe: offline only.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tautline::plot {

/// Red, green, blue, each 0 … 255.
using Rgb = std::array<std::uint8_t, 3>;

/// The colour of a value in [0, 1] (clamped) on the scale of all figures: viridis, even steps of
/// lightness, dark to bright.
[[nodiscard]] Rgb viridis(double value) noexcept;

/// A grey of this lightness, 0 black … 1 white (clamped).
[[nodiscard]] Rgb grey(double lightness) noexcept;

/// An image under everything else of a panel. Pixel (column, row) covers
/// [x_min + column · width, x_min + (column + 1) · width] × [y_min + row · height, …].
struct Raster {
  double x_min{0.0};
  double y_min{0.0};
  double pixel_width{1.0};
  double pixel_height{1.0};
  int columns{0};
  int rows{0};
  std::vector<Rgb> pixels{};  ///< Row by row, row 0 at y_min.
};

/// "low" to "high" as gnuplot's palette of the same scale.
[[nodiscard]] std::string viridisPalette();

}  // namespace tautline::plot
