#include "app/experiments/path_trials.h"

#include <algorithm>

#include <fmt/format.h>

namespace tautline::experiments {

namespace {

Sheet pathSheet(const PathTable& table) {
  Sheet sheet{"flights",
              {"law", "interval_m", "flights", "completed", "broken_off", "trapped",
               "cross_track_mean_m", "cross_track_worst_flight_m", "cross_track_max_m", "turn_deg",
               "bulge_m", "longest_at_axis_s"},
              {}};
  for (const Primitive primitive : kPrimitives) {
    for (const PathMeans& m : of(table, primitive)) {
      const auto number = [](double v) { return fmt::format("{:.4f}", v); };
      sheet.rows.push_back({nameOf(primitive), fmt::format("{:g}", m.interval),
                            fmt::format("{}", m.flights), fmt::format("{}", m.completed),
                            m.broken_off, fmt::format("{}", m.trapped), number(m.mean),
                            number(m.worst), number(m.max), number(m.turn), number(m.bulge),
                            number(m.at_axis)});
    }
  }
  return sheet;
}

plot::Figure tracksFigure(const Setup& setup, const PathPlan& plan, const PathTable& table) {
  plot::Figure figure{.rows = 2, .columns = 3, .width_px = 1500, .height_px = 1000};
  const std::vector<Eigen::Vector3d> ideal = pathCorners(setup, plan.path);
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    std::vector<DrawnTrack> tracks;
    for (const Primitive primitive : kPrimitives)
      tracks.push_back({primitive, of(table, primitive)[k].track});
    plot::Panel panel =
        trackPanel(fmt::format("waypoints every {:g} m", kIntervals[k]), ideal, tracks);
    panel.legend = k == 0;
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

plot::Figure accuracyFigure(const PathTable& table) {
  plot::Figure figure{.rows = 1, .columns = 2, .width_px = 1200, .height_px = 480};
  const auto panel = [&](const char* title, const char* label, double PathMeans::*member) {
    plot::Panel out{.title = title,
                    .x = {.label = "interval of waypoints [m]"},
                    .y = {.label = label, .include_zero = true}};
    for (const Primitive primitive : kPrimitives) {
      plot::Series series{.name = nameOf(primitive),
                          .style = plot::Style::kLinePoints,
                          .colour = colourOf(primitive)};
      for (const PathMeans& m : of(table, primitive))
        series.points.push_back({m.interval, m.*member});
      out.series.push_back(std::move(series));
    }
    return out;
  };
  figure.panels = {panel("Accuracy", "mean cross-track error [m]", &PathMeans::mean),
                   panel("Smoothness", "mean turn every 0.1 m [deg]", &PathMeans::turn)};
  return figure;
}

}  // namespace

std::vector<Trial> pathTrials(const Setup& setup, const PathPlan& plan) {
  std::vector<Trial> all;
  for (const Primitive primitive : kPrimitives) {
    for (const double interval : kIntervals) {
      for (std::uint64_t i = 0; i < plan.trials[static_cast<std::size_t>(primitive)]; ++i) {
        all.push_back(
            {pathTrial(plan.path, primitive, interval, i), [&setup, plan, primitive, interval, i] {
               return flyPath(setup, primitive, plan.path, interval, i, plan.limit, i == 0);
             }});
      }
    }
  }
  return all;
}

PathTable pathTable(const PathPlan& plan, const Results& results) {
  PathTable table;
  for (const Primitive primitive : kPrimitives) {
    const std::uint64_t trials = plan.trials[static_cast<std::size_t>(primitive)];
    for (std::size_t k = 0; k < kIntervals.size(); ++k) {
      PathMeans& m = table[static_cast<std::size_t>(primitive)][k];
      m.interval = kIntervals[k];
      for (std::uint64_t i = 0; i < trials; ++i) {
        const PathFigures f =
            pathFigures(results.at(pathTrial(plan.path, primitive, kIntervals[k], i)));
        const double share = 1.0 / static_cast<double>(trials);
        ++m.flights;
        m.completed += f.completed ? 1 : 0;
        if (!f.completed) m.broken_off = f.reasons;
        m.trapped += f.at_axis > kTrapped ? 1 : 0;
        m.mean += share * f.mean;
        m.turn += share * f.turn;
        m.bulge += share * f.bulge;
        m.worst = std::max(m.worst, f.mean);
        m.max = std::max(m.max, f.max);
        m.at_axis = std::max(m.at_axis, f.at_axis);
        if (i == 0) m.track = f.track;
      }
    }
  }
  return table;
}

std::vector<Row> meanRows(const PathTable& table, Primitive law, std::optional<double> goal) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    rows.push_back({.figure = fmt::format("mean cross-track, {} law, every {:g} m", nameOf(law),
                                          kIntervals[k]),
                    .unit = "m",
                    .as_published = of(table, law)[k].mean,
                    .tautline = of(table, Primitive::kTautline)[k].mean});
    if (goal) rows.back().tautline_band = Band{.max = *goal};
  }
  return rows;
}

void addPictures(const Setup& setup, const PathPlan& plan, const PathTable& table,
                 Findings& findings) {
  findings.sheets.push_back(pathSheet(table));
  findings.pictures.push_back(
      {"tracks", "First trial of each law, seen from above", tracksFigure(setup, plan, table)});
  findings.pictures.push_back({"accuracy",
                               "Accuracy and smoothness against the interval of waypoints",
                               accuracyFigure(table)});
}

}  // namespace tautline::experiments
