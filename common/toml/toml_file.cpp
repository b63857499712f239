#include "common/toml/toml_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>

#include <toml++/toml.h>

#include "common/toml/toml_writer.h"

namespace tautline {

struct TomlFile::Impl {
  std::string name;
  toml::table root;
};

namespace {

int lineOfRegion(const toml::source_region& region) { return static_cast<int>(region.begin.line); }

/// One value on one line. (toml++ formats values well; on arrays it guesses widths from log10 of
/// their numbers, which is undefined behaviour below 1.)
void write(std::ostream& out, const toml::node& node) {
  const char* separator = "";
  if (const auto* table = node.as_table()) {
    out << '{';
    for (const auto& [key, value] : *table) {
      out << separator << key.str() << " = ";
      write(out, value);
      separator = ", ";
    }
    out << '}';
  } else if (const auto* array = node.as_array()) {
    out << '[';
    for (const toml::node& value : *array) {
      out << separator;
      write(out, value);
      separator = ", ";
    }
    out << ']';
  } else {
    node.visit([&out](const auto& n) {
      if constexpr (toml::is_value<decltype(n)>) out << toml::toml_formatter(n);
    });
  }
}

/// How an error shows the value that was found; long ones are cut.
std::string shown(const toml::node& node) {
  std::ostringstream out;
  write(out, node);
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) text = text.substr(0, kLongest - 2) + "…";
  return text;
}

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::optional<double> asNumber(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  return std::nullopt;
}

std::string numberAllowed(Range range) { return "a number, " + rangeText(range); }

/// One step of a dotted key: "elements[3][2]" is the name and two indices.
struct KeyStep {
  std::string name;
  std::vector<std::size_t> indices;
};

std::vector<KeyStep> splitKey(std::string_view dotted) {
  std::vector<KeyStep> steps;
  while (!dotted.empty()) {
    const std::size_t dot = dotted.find('.');
    std::string_view part = dotted.substr(0, dot);
    dotted = dot == std::string_view::npos ? std::string_view() : dotted.substr(dot + 1);
    KeyStep step;
    std::size_t bracket = part.find('[');
    step.name = std::string(part.substr(0, bracket));
    while (bracket != std::string_view::npos) {
      std::size_t index = 0;
      for (const char c : part.substr(bracket + 1)) {
        if (c < '0' || c > '9') break;
        index = index * 10 + static_cast<std::size_t>(c - '0');
      }
      step.indices.push_back(index);
      bracket = part.find('[', bracket + 1);
    }
    steps.push_back(step);
  }
  return steps;
}

}  // namespace

std::string readTextFile(const std::filesystem::path& path) {
  const auto unreadable = [&path](const std::string& why) {
    return InputError(
        {.file = path.string(), .problem = "cannot be read: " + why, .remedy = "check the path"});
  };
  if (std::filesystem::is_directory(path)) throw unreadable("is a folder");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw unreadable(std::strerror(errno));
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) throw unreadable("input/output error");
  return text;
}

TomlFile TomlFile::load(const std::filesystem::path& path) {
  return parse(readTextFile(path), path.string());
}

TomlFile TomlFile::parse(std::string_view text, const std::string& name) {
  try {
    return TomlFile(std::make_shared<Impl>(Impl{name, toml::parse(text)}));
  } catch (const toml::parse_error& e) {
    throw InputError({.file = name,
                      .line = lineOfRegion(e.source()),
                      .problem = "not valid TOML: " + std::string(e.description())});
  }
}

TomlTable TomlFile::root() const { return {*this, &impl_->root, ""}; }

const std::string& TomlFile::name() const noexcept { return impl_->name; }

int TomlFile::lineOf(std::string_view dotted_key) const {
  const toml::node* node = &impl_->root;
  int line = 0;
  for (const KeyStep& step : splitKey(dotted_key)) {
    const toml::table* table = node->as_table();
    if (table == nullptr) return line;
    const auto found = table->find(step.name);
    if (found == table->end()) return line;
    line = lineOfRegion(found->first.source());
    node = &found->second;
    for (const std::size_t index : step.indices) {
      const toml::array* array = node->as_array();
      if (array == nullptr || index >= array->size()) return line;
      node = array->get(index);
      line = lineOfRegion(node->source());
    }
  }
  return line;
}

InputError TomlFile::locate(const InputError& error) const {
  InputProblem problem = error.problem();
  if (problem.file.empty()) {
    problem.file = name();
    if (problem.line == 0) problem.line = lineOf(problem.key);
  }
  return InputError(problem, error.code());
}

std::string TomlTable::pathOf(std::string_view key) const {
  if (key.empty()) return path_;
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

InputError TomlTable::error(std::string_view key, std::string problem, std::string allowed,
                            std::string remedy) const {
  const std::string path = pathOf(key);
  return InputError({.file = file_.name(),
                     .line = file_.lineOf(path),
                     .key = path,
                     .problem = std::move(problem),
                     .allowed = std::move(allowed),
                     .remedy = std::move(remedy)});
}

InputError TomlTable::locate(const InputError& error) const {
  InputProblem problem = error.problem();
  if (problem.file.empty()) problem.key = pathOf(problem.key);
  return file_.locate(InputError(problem, error.code()));
}

InputError TomlTable::missing(std::string_view key) const {
  return error(key, "missing", "", "add it");
}

const void* TomlTable::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return static_cast<const toml::table*>(table_)->get(key);
}

std::vector<double> TomlTable::numbers(const std::string& key, const void* array,
                                       Range range) const {
  std::vector<double> result;
  for (const toml::node& node : *static_cast<const toml::array*>(array)) {
    const std::optional<double> number = asNumber(node);
    if (!number || !range.contains(*number)) {
      throw error(key + "[" + std::to_string(result.size()) + "]",
                  "is " + shown(node) + (number ? "" : ", not a number"), numberAllowed(range));
    }
    result.push_back(*number);
  }
  return result;
}

bool TomlTable::read(std::string_view key, double& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const std::optional<double> number = asNumber(*node);
  if (!number) throw error(key, "is " + shown(*node) + ", not a number", numberAllowed(range));
  if (!range.contains(*number)) throw error(key, "is " + shown(*node), numberAllowed(range));
  value = *number;
  return true;
}

bool TomlTable::read(std::string_view key, int& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const std::string allowed = "an integer, " + rangeText(range);
  const auto* integer = node->as_integer();
  constexpr Range kInt{std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
  if (integer == nullptr) throw error(key, "is " + shown(*node) + ", not an integer", allowed);
  const auto number = static_cast<double>(integer->get());
  if (!range.contains(number) || !kInt.contains(number))
    throw error(key, "is " + shown(*node), allowed);
  value = static_cast<int>(integer->get());
  return true;
}

bool TomlTable::read(std::string_view key, bool& value) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const auto* boolean = node->as_boolean();
  if (boolean == nullptr)
    throw error(key, "is " + shown(*node) + ", not a truth value", "true, false");
  value = boolean->get();
  return true;
}

bool TomlTable::read(std::string_view key, std::string& value) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const auto* text = node->as_string();
  if (text == nullptr) throw error(key, "is " + shown(*node) + ", not a text", "a text in quotes");
  value = text->get();
  return true;
}

bool TomlTable::read(std::string_view key, Eigen::Vector3d& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const std::string allowed = "[x, y, z], each " + rangeText(range);
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) {
    throw error(key, "is " + shown(*node) + ", not three numbers", allowed);
  }
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> number = asNumber(*array->get(i));
    if (!number || !range.contains(*number)) throw error(key, "is " + shown(*node), allowed);
    result[static_cast<Eigen::Index>(i)] = *number;
  }
  value = result;
  return true;
}

bool TomlTable::read(std::string_view key, std::vector<Eigen::Vector2d>& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const std::string allowed = "[[a, b], …], each " + rangeText(range);
  const toml::array* array = node->as_array();
  if (array == nullptr) throw error(key, "is " + shown(*node) + ", not a list of pairs", allowed);
  std::vector<Eigen::Vector2d> result;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string row = std::string(key) + "[" + std::to_string(i) + "]";
    const toml::array* pair = array->get(i)->as_array();
    if (pair == nullptr || pair->size() != 2) {
      throw error(row, "is " + shown(*array->get(i)) + ", not two numbers", allowed);
    }
    const std::optional<double> a = asNumber(*pair->get(0));
    const std::optional<double> b = asNumber(*pair->get(1));
    if (!a || !b || !range.contains(*a) || !range.contains(*b)) {
      throw error(row, "is " + shown(*pair), allowed);
    }
    result.emplace_back(*a, *b);
  }
  value = std::move(result);
  return true;
}

bool TomlTable::read(std::string_view key, std::vector<double>& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    throw error(key, "is " + shown(*node) + ", not a list of numbers",
                "[a, b, …], each " + rangeText(range));
  }
  value = numbers(std::string(key), array, range);
  return true;
}

bool TomlTable::read(std::string_view key, std::vector<std::vector<double>>& value, Range range) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const std::string allowed = "[[a, b, …], [c, …], …], each " + rangeText(range);
  const toml::array* array = node->as_array();
  if (array == nullptr) throw error(key, "is " + shown(*node) + ", not a list of lists", allowed);
  std::vector<std::vector<double>> result;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string row = std::string(key) + "[" + std::to_string(i) + "]";
    const toml::array* entries = array->get(i)->as_array();
    if (entries == nullptr) {
      throw error(row, "is " + shown(*array->get(i)) + ", not a list of numbers", allowed);
    }
    result.push_back(numbers(row, entries, range));
  }
  value = std::move(result);
  return true;
}

bool TomlTable::readChoice(std::string_view key, const std::vector<const char*>& names,
                           std::size_t& index) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return false;
  const auto* text = node->as_string();
  for (std::size_t i = 0; text != nullptr && i < names.size(); ++i) {
    if (text->get() == names[i]) {
      index = i;
      return true;
    }
  }
  throw error(key, "is " + shown(*node), joined({names.begin(), names.end()}));
}

std::vector<TomlTable> TomlTable::table(std::string_view key) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return {};
  if (!node->is_table())
    throw error(key, "is " + shown(*node) + ", not a table", "[" + pathOf(key) + "]");
  return {TomlTable(file_, node->as_table(), pathOf(key))};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const auto* node = static_cast<const toml::node*>(find(key));
  if (node == nullptr) return {};
  const std::string allowed = "[[" + pathOf(key) + "]] or a list of { … }";
  const toml::array* array = node->as_array();
  if (array == nullptr) throw error(key, "is " + shown(*node) + ", not a list of tables", allowed);
  std::vector<TomlTable> result;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string row = std::string(key) + "[" + std::to_string(i) + "]";
    const toml::node& element = *array->get(i);
    if (!element.is_table()) throw error(row, "is " + shown(element) + ", not a table", allowed);
    result.push_back(TomlTable(file_, element.as_table(), pathOf(row)));
  }
  return result;
}

bool TomlTable::has(std::string_view key) const {
  return static_cast<const toml::table*>(table_)->contains(key);
}

std::vector<std::string> TomlTable::tableNames() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : *static_cast<const toml::table*>(table_)) {
    if (node.is_table()) names.emplace_back(key.str());
  }
  return names;
}

void TomlTable::finish() const {
  // In the order of the file, so that the first mistake is the one that is reported.
  const toml::key* first = nullptr;
  for (const auto& [key, node] : *static_cast<const toml::table*>(table_)) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    if (first == nullptr || key.source().begin < first->source().begin) first = &key;
  }
  if (first == nullptr) return;
  const auto nearest =
      std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
        return editDistance(a, first->str()) < editDistance(b, first->str());
      });
  throw error(first->str(), "unknown key", joined(known_),
              nearest == known_.end() ? "remove it" : "did you mean '" + *nearest + "'?");
}

}  // namespace tautline
