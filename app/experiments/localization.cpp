#include "app/experiments/localization.h"

#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "app/experiments/tracked_flight.h"
#include "app/report/series_math.h"
#include "common/mission/scene.h"

namespace tautline::experiments {
namespace {

// Published.
constexpr double kStraightMean = 0.5335;                      // [m]
constexpr double kCorrectedMean = 0.3675;                     // [m]
constexpr std::array kReaches{0.5, 1.0, 1.5, 2.0, 2.5, 3.0};  // [m]
constexpr std::array kHeights{0.5, 1.0, 1.5, 2.0};            // [m]
constexpr double kAzimuth = -45.0 * std::numbers::pi / 180.0;
constexpr double kMeasured = 5.0;  // at the end of the hold [s]

constexpr double kHold = 20.0;  // [s]; the last kMeasured of it count
constexpr Duration kLimit = std::chrono::seconds(200);

struct Side {
  const char* name;
  LocalizerVariant variant;
  bool ours;
  std::optional<double> tension;  // [N]; absent: the plant's
};
constexpr std::array kSides{
    Side{"straight", LocalizerVariant::kStraight, false, {}},
    Side{"corrected", LocalizerVariant::kAsPublishedCode, false, {}},
    Side{"ours", LocalizerVariant::kFilter, true, {}},
    Side{"ours at 1 N", LocalizerVariant::kFilter, true, 1.0},
};

std::string trialName(const Side& side, double reach, double height) {
  return fmt::format("{} {:g} m {:g} m", side.name, reach, height);
}

nlohmann::json hover(const Setup& setup, const Side& side, double reach, double height,
                     std::uint64_t trial) {
  StationConfig station = side.ours ? setup.tautline : setup.as_published;
  station.core.localizer.variant = side.variant;
  bench::LockstepConfig config = setup.flight(
      station, sceneInWorld(readScene(setup.folder / "../scenes/open.scene.toml")), trial);
  if (side.tension) {
    config.sim.vehicle.tension = *side.tension;
    config.station.core.localizer.nominal_tension_n = *side.tension;
  }
  const Eigen::Vector3d target(reach * std::sin(kAzimuth), height, reach * std::cos(kAzimuth));
  const TrackedFlight flight = flyTracked(config, *missionThrough({target}, kHold), kLimit);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const TrackPoint& p : flight.track) {
    if (p.t < flight.track.back().t - kMeasured) continue;
    sum += p.p_WD;
    ++count;
  }
  const Eigen::Vector3d mean = count > 0 ? Eigen::Vector3d(sum / count) : target;
  return {{"completed", flight.result.completed},
          {"error", (mean - target).norm()},
          {"mean", {mean.x(), mean.y(), mean.z()}},
          {"length", target.norm()}};
}

std::vector<Trial> trials(const Setup& setup) {
  std::vector<Trial> all;
  for (const Side& side : kSides) {
    std::uint64_t number = 0;
    for (const double reach : kReaches) {
      for (const double height : kHeights) {
        const std::uint64_t trial = number++;
        if (setup.quick && trial % 6 != 3) continue;
        all.push_back({trialName(side, reach, height), [&setup, &side, reach, height, trial] {
                         return hover(setup, side, reach, height, trial);
                       }});
      }
    }
  }
  return all;
}

Findings judge(const Setup& setup, const Results& results) {
  Findings findings;
  std::array<report::Summary, kSides.size()> summary;
  for (std::size_t s = 0; s < kSides.size(); ++s) {
    std::vector<double> errors;
    std::uint64_t number = 0;
    for (const double reach : kReaches) {
      for (const double height : kHeights) {
        if (setup.quick && number++ % 6 != 3) continue;
        errors.push_back(results.at(trialName(kSides[s], reach, height)).at("error"));
      }
    }
    summary[s] = report::summarize(errors).value_or(report::Summary{});
  }
  findings.rows.push_back({.figure = "mean error, straight tether",
                           .unit = "m",
                           .published = kStraightMean,
                           .as_published = summary[0].mean,
                           .as_published_band = Band{0.45, 0.62}});
  findings.rows.push_back({.figure = "mean error, corrected",
                           .unit = "m",
                           .published = kCorrectedMean,
                           .as_published = summary[1].mean,
                           .tautline = summary[2].mean,
                           .as_published_band = Band{0.29, 0.45},
                           .tautline_band = Band{.max = 0.10}});
  findings.rows.push_back({.figure = "mean error at 1 N",
                           .unit = "m",
                           .tautline = summary[3].mean,
                           .tautline_band = Band{.max = 0.05}});
  return findings;
}

}  // namespace

const Experiment kLocalization{
    "localization", "Tether-based localization",
    "Hover at 24 points of the vertical plane at azimuth −45°, 0.5 to 3 m out and 0.5 to 2 m high; "
    "the error is the distance from the point to the mean true position over the last 5 s.",
    trials, judge};

}  // namespace tautline::experiments
