#pragma once

/// @file
/// A second, independent reading of the wire format for tests: the C++ library's streams instead of
/// the codec's parser.

#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace tautline::testing {

struct TextLine {
  std::string name;
  std::vector<double> fields;
};

/// "Name 1,2.5,-3" -> {"Name", {1, 2.5, -3}}; nothing if a field is not a number.
inline std::optional<TextLine> readTextLine(const std::string& line) {
  TextLine out;
  std::istringstream in(line);
  in.imbue(std::locale::classic());
  std::getline(in, out.name, ' ');
  std::string field;
  while (std::getline(in, field, ',')) {
    std::istringstream number(field);
    number.imbue(std::locale::classic());
    double value = 0.0;
    number >> value;
    if (number.fail() || number.peek() != std::istringstream::traits_type::eof())
      return std::nullopt;
    out.fields.push_back(value);
  }
  return out;
}

}  // namespace tautline::testing
