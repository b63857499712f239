#pragma once

/// @file
/// The hovers of the localization experiment, the sides that fly them, and what came of each.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/plot/figure.h"
#include "estimation/localizer_config.h"

namespace tautline::experiments {

struct LocalizationSide {
  const char* name;
  LocalizerVariant variant;
  bool ours;
  std::optional<double> tension;  ///< [N]; absent: the plant's
  bool biased{true};              ///< False: sensors and reel without bias, to tell what it costs.
};
inline constexpr std::array kLocalizationSides{
    LocalizationSide{"straight", LocalizerVariant::kStraight, false, {}},
    LocalizationSide{"corrected", LocalizerVariant::kAsPublishedCode, false, {}},
    LocalizationSide{"Tautline", LocalizerVariant::kFilter, true, {}},
    LocalizationSide{"Tautline at 1 N", LocalizerVariant::kFilter, true, 1.0},
    LocalizationSide{"Tautline, no bias", LocalizerVariant::kFilter, true, {}, false},
    LocalizationSide{"Tautline at 1 N, no bias", LocalizerVariant::kFilter, true, 1.0, false},
};
enum LocalizationSideIndex : std::size_t {
  kStraight,
  kCorrected,
  kOurs,
  kOursAt1N,
  kUnbiased,
  kUnbiasedAt1N
};

struct Hover {
  double reach{0.0};        ///< Horizontally from the reel [m].
  double height{0.0};       ///< Above it [m].
  std::uint64_t number{0};  ///< Of the trial: same air and noise for each side.

  [[nodiscard]] Eigen::Vector3d target() const;
};
/// The published grid: 24 points of the vertical plane at azimuth −45°.
[[nodiscard]] std::vector<Hover> hovers();

/// What came of one side's hovers.
struct HoverSeries {
  std::vector<double> lengths;         ///< Of the tether, straight to the target [m].
  std::vector<double> errors;          ///< [m]
  std::vector<Hover> flown;            ///< Those that came about.
  std::vector<Eigen::Vector3d> means;  ///< Of the true position, W [m].
  /// Of the errors [m], and of the errors over the lengths [m/m]; infinite without hovers.
  double mean{std::numeric_limits<double>::infinity()};
  double slope{std::numeric_limits<double>::infinity()};
  double lower{0.0};    ///< Hovers below their target [%].
  std::size_t lost{0};  ///< Hovers that never came about.
};
using AllHoverSeries = std::array<HoverSeries, kLocalizationSides.size()>;

/// Mean over the grid of where a straight-line localizer holds the drone when nothing but the sag
/// is wrong: its readings are those of the target's straight line, and the tether hangs as it does.
/// Tension at the drone [N], weight [N/m]; result [m].
[[nodiscard]] double sagError(double tension, double weight);

/// Targets and true means of the published sides and ours, seen at right angles to the plane.
[[nodiscard]] plot::Figure planeFigure(const AllHoverSeries& all);
/// Errors over lengths, with regression lines.
[[nodiscard]] plot::Figure lengthFigure(const AllHoverSeries& all);
/// Mean error of the straight line over tension: `flown` (tension, error), and by sag alone.
[[nodiscard]] plot::Figure tensionFigure(const std::vector<plot::Point>& flown, double published,
                                         double weight);

}  // namespace tautline::experiments
