#include "app/experiments/reel_scale.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/mission/mission_file.h"
#include "common/mission/scene.h"

namespace tautline::experiments {
namespace {

constexpr double kWrong = 1.42;                      // 4.06 mm a count read as 2.85
constexpr std::array kScales{kWrong, 1.0 / kWrong};  // true metres per nominal metre
constexpr std::array kPulls{0.5, 1.0};               // [N] by turns
constexpr double kFound = 0.02;                      // relative error
constexpr double kLeastFlown = 40.0;                 // a shorter flight shows nothing [s]
constexpr double kJudged = 60.0;                     // after take-off [s]
constexpr Duration kLimit = std::chrono::seconds(90);
constexpr double kNeverCalibrated = 0.5;  // prior sigma of the scale
constexpr double kAnyParkedLength = 2.0;  // [m] an uncalibrated reel cannot be checked

/// What the station knows besides its sensors.
struct Knowledge {
  const char* name;
  double home_sigma;  // of home and of the parked tether's slack, as it is told [m]
  double slack;       // that there is, relative to the way home
};
constexpr std::array kKnowledge{
    Knowledge{"parked, measured to 1 cm", 0.01, 0.001},
    Knowledge{"parked, tether 5 % slack", 0.05, 0.05},
    Knowledge{"parked length not used", 10.0, 0.001},
};

int seedCount(const Setup& setup) { return setup.quick ? 2 : 10; }

std::string trialName(const Knowledge& k, double scale, int seed) {
  return fmt::format("{} {:.3f} {}", k.name, scale, seed);
}

nlohmann::json fly(const Setup& setup, const Knowledge& knowledge, double scale, int seed) {
  StationConfig station = setup.tautline;
  station.core.localizer.prior.reel_scale_sigma = kNeverCalibrated;
  station.core.localizer.prior.parked_slack_sigma_m = knowledge.home_sigma;
  station.core.localizer.prior.position_sigma_m = std::min(0.05, knowledge.home_sigma);
  station.core.detect.parked.length_tolerance_m = kAnyParkedLength;
  bench::LockstepConfig config =
      setup.flight(station, sceneInWorld(readScene(setup.folder / "../scenes/open.scene.toml")),
                   static_cast<std::uint64_t>(seed));
  pullWith(config, kPulls[static_cast<std::size_t>(seed) % kPulls.size()]);
  config.sim.reel.scale = scale;
  config.sim.start_slack = knowledge.slack;
  Mission mission = readMission(setup.folder / "../missions/square.mission.toml");
  // It stays up longer than it is watched.
  mission.plan->waypoints[static_cast<std::size_t>(mission.plan->waypoint_count - 1)].hold =
      kJudged;
  bench::Lockstep bench(config, nullptr);
  std::optional<Time> took_off;
  double error = 1.0;
  double sigma = 1.0;
  double wrong_until = 0.0;  // since take-off [s]
  double flown = 0.0;        // as far as it is judged [s]
  bool told = false;
  static_cast<void>(flyMission(bench, *mission.plan, kLimit, [&](const bench::Lockstep& b) {
    if (!took_off && !b.truth().on_ground) took_off = b.now();
    if (!took_off) return;
    const double t = toSeconds(b.now() - *took_off);
    if (t > kJudged) return;
    flown = t;
    const Estimate& e = b.output().estimate;
    error = e.reel_scale / b.truth().reel_scale - 1.0;
    sigma = e.sigma_reel_scale / b.truth().reel_scale;
    if (std::abs(error) > kFound) wrong_until = t;
    told = told || b.output().conditions.has(Condition::kReelScale);
  }));
  return {{"error", error},
          {"sigma", sigma},
          {"wrong_until", wrong_until},
          {"flown", flown},
          {"told", told}};
}

std::vector<Trial> trials(const Setup& setup) {
  std::vector<Trial> all;
  for (const Knowledge& knowledge : kKnowledge) {
    for (const double scale : kScales) {
      for (int seed = 0; seed < seedCount(setup); ++seed) {
        all.push_back({trialName(knowledge, scale, seed), [&setup, &knowledge, scale, seed] {
                         return fly(setup, knowledge, scale, seed);
                       }});
      }
    }
  }
  return all;
}

struct Worst {
  double error{0.0};
  double sigma{0.0};
  double wrong_until{0.0};
  double flown{kJudged};  ///< Shortest.
  int told{0};
};

Worst worstOf(const Setup& setup, const Results& results, const Knowledge& k, double scale) {
  Worst worst;
  for (int seed = 0; seed < seedCount(setup); ++seed) {
    const nlohmann::json& r = results.at(trialName(k, scale, seed));
    worst.error = std::max(worst.error, std::abs(r.at("error").get<double>()));
    worst.sigma = std::max(worst.sigma, r.at("sigma").get<double>());
    worst.wrong_until = std::max(worst.wrong_until, r.at("wrong_until").get<double>());
    worst.flown = std::min(worst.flown, r.at("flown").get<double>());
    worst.told += r.at("told").get<bool>() ? 1 : 0;
  }
  return worst;
}

Findings judge(const Setup& setup, const Results& results) {
  Findings findings;
  for (const Knowledge& k : kKnowledge) {
    const bool judged = &k == &kKnowledge.front();
    for (const double scale : kScales) {
      const Worst worst = worstOf(setup, results, k, scale);
      const std::string which = fmt::format("true scale {:.3f}, {}", scale, k.name);
      Row error{
          .figure = "scale error after 60 s, " + which,
          .unit = "%",
          .tautline = 100.0 * worst.error,
          .note = fmt::format("worst of {} flights, the shortest over after {:.0f} s; the "
                              "filter's own sigma {:.1f} %; REEL_SCALE told in {}",
                              seedCount(setup), worst.flown, 100.0 * worst.sigma, worst.told)};
      Row time{.figure = "time to 2 %, " + which,
               .unit = "s",
               .tautline = worst.wrong_until,
               .note = "last moment with a larger error, worst flight; 0: found on the ground"};
      if (worst.flown < kLeastFlown) error.tautline = time.tautline = std::nullopt;
      if (judged) {
        error.tautline_band = Band{.max = 100.0 * kFound};
        // A scale that is never found is wrong until the flight ends.
        time.tautline_band = Band{.max = std::min(kJudged, worst.flown) - 1.0};
      }
      findings.rows.push_back(error);
      findings.rows.push_back(time);
    }
  }
  return findings;
}

}  // namespace

const Experiment kReelScale{
    "reel_scale", "Reel scale",
    "A reel whose scale is off by 42 %, either way, on a station that is told that it never was "
    "calibrated; a flight of the level rectangle, half of them with 0.5 N and half with 1 N. What "
    "the parked length tells, what is left when "
    "the parked tether lies slack, and what the sensors in flight tell alone.",
    trials, judge};

}  // namespace tautline::experiments
