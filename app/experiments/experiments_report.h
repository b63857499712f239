#pragma once

/// @file
/// The experiments' findings as files: report.json for programs, report.html and report.md for
/// people, report.csv and a CSV for each sheet, an SVG for each picture. docs/experiments.md.

#include <filesystem>
#include <string>
#include <vector>

#include "app/experiments/run_experiments.h"

namespace tautline::experiments {

/// One JSON array of rows {experiment, figure, unit, published, as_published, tautline, band, pass,
/// note, shortfall}; band = {as_published, tautline}, each [min, max] or null, a missing bound
/// null.
[[nodiscard]] std::string reportJson(const std::vector<Chapter>& chapters);

/// The table of all rows for a terminal.
[[nodiscard]] std::string reportText(const std::vector<Chapter>& chapters);

/// Writes all files together or none. Returns report.html's path. Throws InputError.
std::filesystem::path writeReport(const Setup& setup, const std::vector<Chapter>& chapters,
                                  const std::filesystem::path& folder);

}  // namespace tautline::experiments
