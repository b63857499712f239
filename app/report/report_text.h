#pragma once

/// @file
/// A flight report as text: JSON for programs, HTML for people, CSV for spreadsheets, a few lines
/// for the terminal. Pure functions; keys and columns: docs/report.md.

#include <string>
#include <vector>

#include "app/report/analysis.h"
#include "app/report/flight_log.h"
#include "app/report/html.h"

namespace tautline::report {

/// report.json. What cannot be computed is null.
[[nodiscard]] std::string reportJson(const FlightLog& log, const FlightAnalysis& flight);

/// series.csv: one row per ESTIMATE (per SIM_TRUTH in a log without), empty fields where there is
/// no value.
[[nodiscard]] std::string seriesCsv(const FlightLog& log, const FlightAnalysis& flight);

/// The summary that the command prints.
[[nodiscard]] std::string summaryText(const FlightLog& log, const FlightAnalysis& flight);

/// report.html: one file with everything in it.
[[nodiscard]] std::string reportHtml(const FlightLog& log, const FlightAnalysis& flight,
                                     const std::vector<EmbeddedPicture>& pictures);

/// SIM, HIL, REAL or "unknown".
[[nodiscard]] std::string runModeName(const FlightAnalysis& flight);

/// The log's start as UTC, "2026-03-01 14:05:09 UTC"; empty for a virtual clock that starts near 0.
[[nodiscard]] std::string startTimeText(const FlightLog& log);

}  // namespace tautline::report
