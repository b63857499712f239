#pragma once

/// @file
/// Writes a flight report to a folder. Not real-time safe.

#include <filesystem>
#include <vector>

#include "app/report/analysis.h"
#include "app/report/flight_log.h"
#include "common/mission/scene.h"

namespace tautline::report {

/// Writes report.json, report.html, series.csv and the pictures. All are made in a temporary folder
/// beside `folder` and moved into place at the end: after an error (InputError: no gnuplot, disk
/// full, no permission) `folder` is as it was. Other files in it stay. `scene` (in W) is drawn
/// where given. Returns the files' paths, report.html first.
std::vector<std::filesystem::path> writeReport(const FlightLog& log, const FlightAnalysis& flight,
                                               const Scene* scene,
                                               const std::filesystem::path& folder);

}  // namespace tautline::report
