#pragma once

/// @file
/// Tables of elementary risks from TOML, as the dissertation prints them:
///
///     elements = [[0.01, 0.02, 0.04], [0.01, 0.02]]   # one row a state, one risk an element
///
/// at the top of the file or in one of its tables (`[red_path]`). In place of `elements` there may
/// be `finish = [0.99, 1.0]`, the probability of finishing each state: one risk 1 − finish a state.
/// Other keys are not looked at: such files carry rewards and printed results beside their tables.
/// Not real-time safe: offline only.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tautline::planning {

/// One row a state, at least one number each, from `[table]`; if `table` is empty, what stands at
/// the top of the file, else the only table that has risks. Throws InputError with file, line and
/// key: not readable, no or several tables to choose from, no rows, an empty row, a number outside
/// [0, 1].
[[nodiscard]] std::vector<std::vector<double>> readRiskTable(const std::filesystem::path& path,
                                                             std::string_view table = {});

/// `name` stands for the file in errors.
[[nodiscard]] std::vector<std::vector<double>> parseRiskTable(std::string_view text,
                                                              const std::string& name,
                                                              std::string_view table = {});

}  // namespace tautline::planning
