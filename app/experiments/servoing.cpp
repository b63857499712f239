#include "app/experiments/servoing.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "app/experiments/servo_flight.h"
#include "app/report/series_math.h"
#include "common/mission/scene.h"

namespace tautline::experiments {
namespace {

constexpr double kUnit = 0.085;  // of the published figures [m]

/// A column of the published table, and how far from it the simulated one may be.
struct Axis {
  const char* name;
  const char* unit;
  double published_rms;
};
constexpr std::array kAxes{Axis{"x, to the right", "unit", 1.6998},
                           Axis{"y, down", "unit", 1.7042},
                           Axis{"z, depth", "unit", 2.8976},
                           Axis{"distance", "unit", 3.7669},
                           Axis{"yaw", "rad", 0.0812},
                           Axis{"pitch", "rad", 0.1175},
                           Axis{"roll", "rad", 0.0324}};
using AxisValues = std::array<double, kAxes.size()>;

constexpr std::array kSides{ServoLaw::kAsPublished, ServoLaw::kTracking};

int flightsOf(const Setup& setup) { return setup.quick ? 2 : 12; }

std::string trialName(ServoLaw law, int flight) {
  return fmt::format("{} {}", nameOf(law, kServoLawNames), flight);
}

nlohmann::json servo(const Setup& setup, ServoLaw law, int number) {
  ServoFlightConfig config;
  const bool ours = law == ServoLaw::kTracking;
  config.bench = setup.flight(ours ? setup.tautline : setup.as_published,
                              sceneInWorld(readScene(setup.folder / "../scenes/open.scene.toml")),
                              static_cast<std::uint64_t>(number));
  config.servo.law = law;
  config.servo.standoff_m = 10.0 * kUnit;
  config.servo.position = config.bench.station.core.control.position;
  const ServoFlight flight = flyServo(config);

  AxisValues squares{};
  nlohmann::json track = nlohmann::json::array();
  for (const ServoError& e : flight.errors) {
    const Eigen::Vector3d u = e.translation / kUnit;
    const AxisValues values{u.x(), u.y(), u.z(), u.norm(), e.yaw, e.pitch, e.roll};
    for (std::size_t i = 0; i < values.size(); ++i) squares[i] += values[i] * values[i];
    track.push_back({e.t, u.x(), u.y(), u.z(), e.p_WD.x(), e.p_WD.z(), e.p_WM.x(), e.p_WM.z()});
  }
  AxisValues rms{};
  const auto count = static_cast<double>(std::max<std::size_t>(flight.errors.size(), 1));
  for (std::size_t i = 0; i < rms.size(); ++i) rms[i] = std::sqrt(squares[i] / count);
  nlohmann::json result{{"servoed", flight.servoed}, {"in_sight", flight.in_sight}, {"rms", rms}};
  if (number == 0) result["track"] = track;  // for the pictures
  return result;
}

std::vector<Trial> trials(const Setup& setup) {
  std::vector<Trial> all;
  for (const ServoLaw law : kSides) {
    for (int i = 0; i < flightsOf(setup); ++i)
      all.push_back({trialName(law, i), [&setup, law, i] { return servo(setup, law, i); }});
  }
  return all;
}

/// Root mean square over all flights; all of them are equally long. None if one was not servoed.
std::optional<AxisValues> pooled(const Setup& setup, const Results& results, ServoLaw law) {
  AxisValues sum{};
  for (int i = 0; i < flightsOf(setup); ++i) {
    const nlohmann::json& flight = results.at(trialName(law, i));
    if (!flight.at("servoed").get<bool>()) return std::nullopt;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double value = flight.at("rms").at(k);
      sum[k] += value * value / flightsOf(setup);
    }
  }
  for (double& value : sum) value = std::sqrt(value);
  return sum;
}

double shareServoed(const Setup& setup, const Results& results, ServoLaw law) {
  int servoed = 0;
  for (int i = 0; i < flightsOf(setup); ++i)
    servoed += results.at(trialName(law, i)).at("servoed").get<bool>() ? 1 : 0;
  return static_cast<double>(servoed) / flightsOf(setup);
}

plot::Figure errorFigure(const Results& results) {
  plot::Figure figure;
  figure.rows = 2;
  figure.columns = 2;
  figure.width_px = 1000;
  figure.height_px = 700;
  const std::array labels{"x [unit]", "y [unit]", "z [unit]"};
  for (std::size_t axis = 0; axis < labels.size(); ++axis) {
    plot::Panel panel;
    panel.x.label = "time [s]";
    panel.y.label = labels[axis];
    for (const ServoLaw law : kSides) {
      plot::Series series;
      series.name = law == ServoLaw::kTracking ? "Tautline" : "as published";
      series.colour = law == ServoLaw::kTracking ? plot::Colour::kGreen : plot::Colour::kVermilion;
      for (const nlohmann::json& p : results.at(trialName(law, 0)).at("track"))
        series.points.push_back({p.at(0), p.at(axis + 1)});
      panel.series.push_back(series);
    }
    figure.panels.push_back(panel);
  }
  plot::Panel top;
  top.title = "from above";
  top.x.label = "x [m]";
  top.y.label = "z [m]";
  top.y.reversed = true;
  top.equal_aspect = true;
  plot::Series marker{.name = "marker", .style = plot::Style::kDashed};
  marker.colour = plot::Colour::kBlack;
  for (const ServoLaw law : kSides) {
    plot::Series drone;
    drone.name = law == ServoLaw::kTracking ? "Tautline" : "as published";
    drone.colour = law == ServoLaw::kTracking ? plot::Colour::kGreen : plot::Colour::kVermilion;
    for (const nlohmann::json& p : results.at(trialName(law, 0)).at("track")) {
      drone.points.push_back({p.at(4), p.at(5)});
      if (law == ServoLaw::kTracking) marker.points.push_back({p.at(6), p.at(7)});
    }
    top.series.push_back(drone);
  }
  top.series.push_back(marker);
  top.markers.push_back({.at = {0.0, 0.0}, .label = "reel"});
  figure.panels.push_back(top);
  return figure;
}

Findings judge(const Setup& setup, const Results& results) {
  Findings findings;
  const std::optional<AxisValues> published = pooled(setup, results, ServoLaw::kAsPublished);
  const std::optional<AxisValues> ours = pooled(setup, results, ServoLaw::kTracking);
  findings.rows.push_back({.figure = "flights servoed to the end",
                           .unit = "",
                           .published = 1.0,
                           .as_published = shareServoed(setup, results, ServoLaw::kAsPublished),
                           .tautline = shareServoed(setup, results, ServoLaw::kTracking),
                           .tautline_band = Band{1.0, 1.0}});
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    Row row{.figure = fmt::format("RMS error of {}", kAxes[i].name),
            .unit = kAxes[i].unit,
            .published = kAxes[i].published_rms,
            .as_published = published ? std::optional((*published)[i]) : std::nullopt,
            .tautline = ours ? std::optional((*ours)[i]) : std::nullopt,
            .note = "how fast the marker was carried is not published"};
    if (i < 4) row.tautline_band = Band{.max = kAxes[i].published_rms};
    findings.rows.push_back(row);
  }
  findings.pictures.push_back(
      {"errors", "Errors of the first flight behind the carried marker; 1 unit is 8.5 cm.",
       errorFigure(results)});
  return findings;
}

}  // namespace

const Experiment kServoing{
    "servoing", "Visual servoing",
    "A marker is carried round the reel for 120 s, through all four quadrants; the drone keeps 10 "
    "units (0.85 m) before it. Servo and camera are an operator's program that moves the sticks. "
    "Errors are of the true pose in the camera's frame, from 15 s on.",
    trials, judge};

}  // namespace tautline::experiments
