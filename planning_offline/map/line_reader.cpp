#include "planning_offline/map/line_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tautline::planning {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::size_t kShown = 24;  // characters of a foreign text in an error

template <class Number>
std::optional<Number> parsed(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

bool LineReader::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  ++number_;
  return true;
}

bool LineReader::nextNotBlank() {
  while (next()) {
    if (line_.find_first_not_of(kBlanks) != std::string_view::npos) return true;
  }
  return false;
}

std::vector<std::string_view> LineReader::words() const {
  std::vector<std::string_view> words;
  std::size_t begin = line_.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line_.find_first_of(kBlanks, begin), line_.size());
    words.push_back(line_.substr(begin, end - begin));
    begin = line_.find_first_not_of(kBlanks, end);
  }
  return words;
}

InputError LineReader::error(std::string problem, std::string allowed, std::string remedy) const {
  return InputError({.file = file_,
                     .line = number_,
                     .problem = std::move(problem),
                     .allowed = std::move(allowed),
                     .remedy = std::move(remedy)});
}

std::optional<int> integerOf(std::string_view word) { return parsed<int>(word); }

std::optional<double> numberOf(std::string_view word) {
  const std::optional<double> value = parsed<double>(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::string shownText(std::string_view text) {
  std::string shown(text.substr(0, kShown));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + shown + (text.size() > kShown ? "…'" : "'");
}

}  // namespace tautline::planning
