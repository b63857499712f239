#pragma once

/// @file
/// Values as TOML text. Real numbers are the shortest decimal text that reads back to the same
/// bits. Not real-time safe: start-up only.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "common/fields.h"

namespace tautline {

[[nodiscard]] std::string tomlText(double value);
[[nodiscard]] std::string tomlText(int value);
[[nodiscard]] std::string tomlText(bool value);
[[nodiscard]] std::string tomlText(const std::string& value);  ///< Quoted and escaped.
[[nodiscard]] std::string tomlText(const Eigen::Vector3d& value);
[[nodiscard]] std::string tomlText(std::span<const Eigen::Vector2d> points);

/// "0.1 to 5", "at least 0", "at most 1", or "any finite number".
[[nodiscard]] std::string rangeText(Range range);

/// Writes `text` to a temporary file beside `path`, then renames it: at every moment `path` is
/// either the old file or the whole new one. Throws InputError if that fails; nothing is left
/// behind.
void writeFileAtomically(const std::filesystem::path& path, std::string_view text);

}  // namespace tautline
