#include "app/experiments/risk_truth.h"

#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "app/experiments/truth_paths.h"
#include "common/toml/config_file.h"

namespace tautline::experiments {
namespace {

TruthOptions optionsOf(const Setup& setup) {
  TruthOptions options{.seed = setup.seed};
  if (setup.quick) {
    options.maps = 8;
    options.goals = 1;
    options.flights = 4;
  }
  return options;
}

CampaignFlight whoFlies(const Setup& setup, std::size_t station) {
  CampaignFlight who;
  who.station = demonstrationStation(setup, station);
  who.plant = setup.plant;
  return who;
}

std::string trialName(std::size_t station, const TruthCase& c) {
  return fmt::format("{} {}", kStationNames[station], c.name());
}

std::vector<Trial> trials(const Setup& setup) {
  const auto params = std::make_shared<const planning::RiskParams>(
      loadConfig<planning::RiskParams>(setup.folder / "../risk/dissertation.toml"));
  std::vector<Trial> all;
  for (std::size_t station = 0; station < kStationNames.size(); ++station) {
    for (const TruthCase& c : truthCases(optionsOf(setup))) {
      all.push_back({trialName(station, c), [&setup, params, station, c] {
                       return toJson(
                           flyTruthCase(c, optionsOf(setup), *params, whoFlies(setup, station)));
                     }});
    }
  }
  return all;
}

void append(std::array<Measure, kMeasures>& to, const std::array<Measure, kMeasures>& from) {
  for (std::size_t m = 0; m < kMeasures; ++m) {
    to[m].name = from[m].name;
    to[m].forecasts.insert(to[m].forecasts.end(), from[m].forecasts.begin(),
                           from[m].forecasts.end());
  }
}

/// What one station's flights say.
struct Side {
  std::vector<TruthPath> all;                              ///< In the order of the cases.
  std::vector<TruthPath> paths;                            ///< That were flown.
  std::optional<std::array<Measure, kMeasures>> measures;  ///< On rooms that fits have not seen.

  [[nodiscard]] std::optional<double> error(MeasureIndex m) const {
    if (!measures) return {};
    return calibrationError((*measures)[m].forecasts);
  }
};

Side sideOf(const Setup& setup, const Results& results, std::size_t station) {
  Side side;
  for (const TruthCase& c : truthCases(optionsOf(setup))) {
    TruthPath path = truthPathFrom(results.at(trialName(station, c)));
    if (path.flights() > 0) side.paths.push_back(path);
    side.all.push_back(std::move(path));
  }
  // Each half of the rooms is judged with what the other half says.
  const Halves halves = halve(side.paths);
  if (!halves.even.empty() && !halves.odd.empty()) {
    side.measures.emplace();
    append(*side.measures, measure(halves.odd, halves.even));
    append(*side.measures, measure(halves.even, halves.odd));
  }
  return side;
}

/// Of all flights of all paths; none where no path was planned.
std::optional<double> shareBegun(const Side& side) {
  std::int64_t begun = 0;
  std::int64_t tried = 0;
  for (const TruthPath& path : side.all) {
    begun += path.flights();
    tried = std::accumulate(path.ends.begin(), path.ends.end(), tried);
  }
  if (tried == 0) return {};
  return static_cast<double>(begun) / static_cast<double>(tried);
}

Sheet pathsSheet(const std::array<Side, 2>& sides) {
  Sheet sheet{"paths",
              {"<station", "room", "<planner", "states", "risk index", "additive", "flights",
               "failed", "95 % from", "to"},
              {}};
  for (const auto& end : kFlightEndNames) sheet.columns.emplace_back(end.name);
  for (std::size_t s = 0; s < sides.size(); ++s) {
    for (const TruthPath& p : sides[s].paths) {
      const Interval i = clopperPearson(p.failed(), p.flights());
      std::vector<std::string> row{kStationNames[s],
                                   std::to_string(p.map),
                                   p.planner,
                                   std::to_string(p.points.size()),
                                   fmt::format("{:.3f}", p.prediction.risk),
                                   fmt::format("{:.3f}", p.prediction.additive),
                                   std::to_string(p.flights()),
                                   std::to_string(p.failed()),
                                   fmt::format("{:.3f}", i.low),
                                   fmt::format("{:.3f}", i.high)};
      for (const std::int64_t count : p.ends) row.push_back(std::to_string(count));
      sheet.rows.push_back(std::move(row));
    }
  }
  return sheet;
}

Sheet measuresSheet(const std::array<Side, 2>& sides) {
  Sheet sheet{
      "measures", {"<station", "<measure", "flights", "Brier score", "calibration error"}, {}};
  for (std::size_t s = 0; s < sides.size(); ++s) {
    if (!sides[s].measures) continue;
    for (const Measure& m : *sides[s].measures) {
      std::int64_t flights = 0;
      for (const Forecast& f : m.forecasts) flights += f.flights;
      sheet.rows.push_back({kStationNames[s], m.name, std::to_string(flights),
                            fmt::format("{:.4f}", brierScore(m.forecasts)),
                            fmt::format("{:.4f}", calibrationError(m.forecasts))});
    }
  }
  return sheet;
}

Picture reliabilityPicture(const Side& side, std::size_t station) {
  plot::Figure figure;
  figure.title = fmt::format("Predicted and simulated failures, {}", kStationNames[station]);
  figure.rows = 2;
  figure.columns = 2;
  figure.width_px = 1000;
  figure.height_px = 900;
  constexpr std::array kShown{kIndex, kAdditive, kIndexFitted, kAdditiveScaled};
  for (const MeasureIndex m : kShown) {
    figure.panels.push_back(reliabilityPanel(
        (*side.measures)[m].forecasts, (*side.measures)[m].name,
        m == kIndex || m == kIndexFitted ? plot::Colour::kBlue : plot::Colour::kVermilion));
  }
  return {fmt::format("reliability_{}", station == 0 ? "as_published" : "tautline"),
          "Share of flights that failed over the predicted probability: single paths in grey, "
          "tenths of the predictions with the exact 95 % interval; on the dashed line a measure "
          "tells the truth. Fitted measures are judged on rooms that they have not seen.",
          std::move(figure)};
}

constexpr double kSignificant = 1.645;  // standard errors: one side, 95 %

/// Standard error of the mean of differences, one a path; paths are independent, flights of one
/// path are not.
double standardError(const std::vector<double>& differences) {
  const auto n = static_cast<double>(differences.size());
  if (n < 2.0) return 0.0;
  const double mean = std::accumulate(differences.begin(), differences.end(), 0.0) / n;
  double sum = 0.0;
  for (const double d : differences) sum += (d - mean) * (d - mean);
  return std::sqrt(sum / (n * (n - 1.0)));
}

/// Two figures of which the first must not be significantly above the second.
struct Comparison {
  std::optional<double> figure;
  std::optional<double> limit;
};

Comparison compareScores(const Side& side, MeasureIndex ours, MeasureIndex other) {
  if (!side.measures) return {};
  const std::vector<Forecast>& a = (*side.measures)[ours].forecasts;
  const std::vector<Forecast>& b = (*side.measures)[other].forecasts;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i)
    differences.push_back(brierScore({a[i]}) - brierScore({b[i]}));
  return {brierScore(a), brierScore(b) + kSignificant * standardError(differences)};
}

/// Shares of failures of both planners' paths to the same goals, which stand side by side.
Comparison compareShares(const std::vector<TruthPath>& all) {
  std::vector<double> least;
  std::vector<double> differences;
  double additive = 0.0;
  const auto share = [](const TruthPath& p) {
    return static_cast<double>(p.failed()) / static_cast<double>(p.flights());
  };
  for (std::size_t i = 0; i + 1 < all.size(); i += kTruthPlanners.size()) {
    if (all[i].flights() == 0 || all[i + 1].flights() == 0) continue;
    least.push_back(share(all[i]));
    differences.push_back(least.back() - share(all[i + 1]));
    additive += share(all[i + 1]);
  }
  if (least.empty()) return {};
  const auto n = static_cast<double>(least.size());
  return {std::accumulate(least.begin(), least.end(), 0.0) / n,
          additive / n + kSignificant * standardError(differences)};
}

Row rowOf(const std::string& figure, const std::array<Comparison, 2>& sides,
          const std::string& note) {
  const auto atMost = [](const std::optional<double>& limit) {
    return limit ? std::optional(Band{.max = *limit}) : std::nullopt;
  };
  return {.figure = figure,
          .as_published = sides[0].figure,
          .tautline = sides[1].figure,
          .as_published_band = atMost(sides[0].limit),
          .tautline_band = atMost(sides[1].limit),
          .note = note};
}

Findings judge(const Setup& setup, const Results& results) {
  const std::array<Side, 2> sides{sideOf(setup, results, 0), sideOf(setup, results, 1)};
  const auto scores = [&](MeasureIndex ours, MeasureIndex other) {
    return std::array{compareScores(sides[0], ours, other), compareScores(sides[1], ours, other)};
  };
  const std::string significant =
      " plus 1.645 standard errors of the difference over the paths: above it the index is "
      "significantly worse.";
  constexpr Band kMost{.min = 0.9, .max = 1.0};
  Findings findings;
  findings.rows.push_back({.figure = "share of the flights that began",
                           .as_published = shareBegun(sides[0]),
                           .tautline = shareBegun(sides[1]),
                           .as_published_band = kMost,
                           .tautline_band = kMost,
                           .note = "The others, whose mission was refused, count nowhere."});
  findings.rows.push_back(rowOf("Brier score of the risk index", scores(kIndex, kAdditive),
                                "The band ends at the score of the additive measure, read as a "
                                "probability by the union bound," +
                                    significant));
  findings.rows.push_back(rowOf(
      "Brier score, one fitted factor each", scores(kIndexScaled, kAdditiveScaled),
      "Fitted on the other half of the rooms. The band ends at the score of the additive measure "
      "with as much freedom," +
          significant));
  findings.rows.push_back(
      rowOf("Brier score, six fitted elements", scores(kIndexFitted, kBaseRate),
            "The band ends at the score of the share of failures alone," + significant));
  findings.rows.push_back(
      {.figure = "calibration error, six fitted elements",
       .as_published = sides[0].error(kIndexFitted),
       .tautline = sides[1].error(kIndexFitted),
       .note = "Told, not judged: with few flights a path it is scatter for the most part."});
  findings.rows.push_back(rowOf("share of failures on paths of least risk",
                                {compareShares(sides[0].all), compareShares(sides[1].all)},
                                "The band ends at the share on the additive planner's paths to the "
                                "same goals," +
                                    significant));
  findings.sheets.push_back(measuresSheet(sides));
  findings.sheets.push_back(pathsSheet(sides));
  for (std::size_t s = 0; s < sides.size(); ++s) {
    if (sides[s].measures) findings.pictures.push_back(reliabilityPicture(sides[s], s));
  }
  return findings;
}

}  // namespace

const Experiment kRiskTruth{
    "risk_truth", "Does the risk index tell the truth?",
    "Planned paths through generated rooms of 4 to 32 things (the staircase's size, voxels, reel "
    "and "
    "start), by the planner of least risk and by the additive one, to the same goals, each flown "
    "many times by both stations. Predicted is the risk index with the dissertation's parameters, "
    "and the additive measure: the sum of its locale risks over the path's states.",
    trials, judge};

}  // namespace tautline::experiments
