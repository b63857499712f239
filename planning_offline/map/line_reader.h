#pragma once

/// @file
/// Line-based text files of numbers and words (MovingAI maps and scenarios). Not real-time safe:
/// offline only.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.h"

namespace tautline::planning {

/// Walks over the lines of a text, which must outlive it. LF or CRLF, with or without one at the
/// end.
class LineReader {
 public:
  /// `file` stands for the file in errors.
  LineReader(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {}

  /// Goes to the next line; false at the end.
  bool next();
  /// Goes to the next line that is not blank; false at the end.
  bool nextNotBlank();

  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] std::string_view line() const noexcept { return line_; }
  [[nodiscard]] int number() const noexcept { return number_; }  ///< Of the line, from 1.
  /// What stands between spaces and tabs.
  [[nodiscard]] std::vector<std::string_view> words() const;
  /// An error about this line.
  [[nodiscard]] InputError error(std::string problem, std::string allowed = {},
                                 std::string remedy = {}) const;

 private:
  std::string file_;
  std::string_view rest_;
  std::string_view line_;
  int number_{0};
};

/// The whole word as a number, or nothing. Independent of the locale.
[[nodiscard]] std::optional<int> integerOf(std::string_view word);
[[nodiscard]] std::optional<double> numberOf(std::string_view word);  ///< Finite.

/// Words of a foreign file as they may be shown: shortened, what is not printable as '?'.
[[nodiscard]] std::string shownText(std::string_view text);

}  // namespace tautline::planning
