#pragma once

/// @file
/// The pictures of a flight report, as data. What each shows: docs/report.md.

#include <string>
#include <vector>

#include "app/report/analysis.h"
#include "app/report/flight_log.h"
#include "common/plot/figure.h"
#include "common/plot/views.h"

namespace tautline::report {

struct NamedFigure {
  std::string name;     ///< File name without ".svg".
  std::string caption;  ///< One sentence for people.
  bool on_page{true};   ///< Shown in report.html.
  plot::Figure figure;
};

/// Paths, contacts and landmarks of the flight in space, without obstacles.
[[nodiscard]] plot::Drawing flightDrawing(const FlightAnalysis& flight);

/// All pictures; `scene` (in W) is drawn into the views where given. A picture without any data is
/// left out.
[[nodiscard]] std::vector<NamedFigure> reportFigures(const FlightLog& log,
                                                     const FlightAnalysis& flight,
                                                     const Scene* scene);

}  // namespace tautline::report
