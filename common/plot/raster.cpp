#include "common/plot/raster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace tautline::plot {
namespace {

// Viridis, abridged to five points.
constexpr std::array<Rgb, 5> kScale{{{0x44, 0x01, 0x54},
                                     {0x3b, 0x52, 0x8b},
                                     {0x21, 0x91, 0x8c},
                                     {0x5e, 0xc9, 0x62},
                                     {0xfd, 0xe7, 0x25}}};

std::uint8_t byteOf(double value) noexcept {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

Rgb viridis(double value) noexcept {
  const double at = std::clamp(value, 0.0, 1.0) * static_cast<double>(kScale.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), kScale.size() - 2);
  const double t = at - static_cast<double>(low);
  Rgb out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = byteOf((1.0 - t) * static_cast<double>(kScale[low][i]) +
                    t * static_cast<double>(kScale[low + 1][i]));
  }
  return out;
}

Rgb grey(double lightness) noexcept {
  const std::uint8_t level = byteOf(255.0 * lightness);
  return {level, level, level};
}

std::string viridisPalette() {
  std::string out;
  for (std::size_t i = 0; i < kScale.size(); ++i) {
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "%s%zu '#%02x%02x%02x'", i == 0 ? "" : ", ", i,
                  kScale[i][0], kScale[i][1], kScale[i][2]);
    out += text.data();
  }
  return out;
}

}  // namespace tautline::plot
