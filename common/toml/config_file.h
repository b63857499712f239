#pragma once

/// @file
/// Config structs from and to TOML, through their one list of fields (common/fields.h):
///
///     const StationConfig config = loadConfig<StationConfig>("config/station.toml");
///     log << dumpConfig(config);  // every key with its effective value and its documentation
///
/// Reading is strict: an unknown key, a wrong type, NaN or infinity, a value out of range or an
/// unknown choice throws one InputError with file, line, key, value, what is allowed and the
/// remedy. Missing keys keep the struct's default. A struct may have `void validate() const`, which
/// throws InputError for what a single range cannot say; its `key` is enough, file and line are
/// added here. Reading back a dump gives the same struct, bit for bit. Not real-time safe: start-up
/// only.

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "common/error.h"
#include "common/fields.h"
#include "common/fixed_list.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"

namespace tautline {

/// Visitor of common/fields.h that fills a struct from a table.
class ConfigReader {
 public:
  explicit ConfigReader(TomlTable table) : table_(std::move(table)) {}

  template <class T>
  void field(const char* key, T& value, const char* /*doc*/) {
    table_.read(key, value);
  }
  template <class T>
  void field(const char* key, T& value, Range range, const char* /*doc*/) {
    table_.read(key, value, range);
  }
  template <class Enum, std::size_t N>
  void choice(const char* key, Enum& value, const std::array<EnumName<Enum>, N>& names,
              const char* /*doc*/) {
    std::vector<const char*> texts;
    for (const auto& entry : names) texts.push_back(entry.name);
    std::size_t index = 0;
    if (table_.readChoice(key, texts, index)) value = names[index].value;
  }
  template <std::size_t N>
  void field(const char* key, FixedList<Eigen::Vector2d, N>& value, Range range,
             const char* /*doc*/) {
    std::vector<Eigen::Vector2d> points;
    if (!table_.read(key, points, range)) return;
    value.clear();
    for (const Eigen::Vector2d& point : points)
      if (!value.add(point)) throw tooMany(key, points.size(), N);
  }
  template <class Struct, std::size_t N>
  void rows(const char* key, FixedList<Struct, N>& value, const char* /*doc*/) {
    std::vector<TomlTable> tables = table_.tables(key);
    if (tables.size() > N) throw tooMany(key, tables.size(), N);
    if (!tables.empty()) value.clear();
    for (TomlTable& table : tables) {
      Struct row{};
      readStruct(std::move(table), row);
      value.add(row);
    }
  }
  template <class Struct>
  void section(const char* key, Struct& value) {
    for (TomlTable& table : table_.table(key)) readStruct(std::move(table), value);
  }

  /// Reads all fields of `value`, refuses unknown keys, then calls its validate() if it has one.
  template <class Struct>
  static void readStruct(TomlTable table, Struct& value) {
    ConfigReader reader(std::move(table));
    value.fields(reader);
    reader.table_.finish();
    if constexpr (requires(const Struct& s) { s.validate(); }) {
      try {
        value.validate();
      } catch (const InputError& e) {
        throw reader.table_.locate(e);
      }
    }
  }

 private:
  [[nodiscard]] InputError tooMany(const char* key, std::size_t count, std::size_t room) const;

  TomlTable table_;
};

/// Visitor of common/fields.h that writes a struct with its documentation.
class ConfigWriter {
 public:
  /// @param row the table is one of an array of tables.
  explicit ConfigWriter(std::string path, bool row = false) : path_(std::move(path)), row_(row) {}

  template <class T>
  void field(const char* key, const T& value, const char* doc) {
    line(key, tomlText(value), doc, {});
  }
  template <class T>
  void field(const char* key, const T& value, Range range, const char* doc) {
    line(key, tomlText(value), doc, rangeText(range));
  }
  template <class Enum, std::size_t N>
  void choice(const char* key, const Enum& value, const std::array<EnumName<Enum>, N>& names,
              const char* doc) {
    std::string allowed;
    for (const auto& entry : names)
      allowed += (allowed.empty() ? "" : ", ") + std::string(entry.name);
    line(key, tomlText(std::string(nameOf(value, names))), doc, allowed);
  }
  template <std::size_t N>
  void field(const char* key, const FixedList<Eigen::Vector2d, N>& value, Range range,
             const char* doc) {
    line(key, tomlText(value.all()), doc, rangeText(range));
  }
  template <class Struct, std::size_t N>
  void rows(const char* key, FixedList<Struct, N>& value, const char* /*doc*/) {
    for (Struct& row : value.all()) {
      ConfigWriter inner(path_.empty() ? key : path_ + "." + key, true);
      row.fields(inner);
      sections_ += inner.text();
    }
  }
  template <class Struct>
  void section(const char* key, Struct& value) {
    ConfigWriter inner(path_.empty() ? key : path_ + "." + key);
    value.fields(inner);
    sections_ += inner.text();
  }

  /// Keys of a table stand before its sub-tables, whatever the order of the fields.
  [[nodiscard]] std::string text() const {
    const std::string header = row_ ? "[[" + path_ + "]]" : "[" + path_ + "]";
    return (path_.empty() ? "" : "\n" + header + "\n") + keys_ + sections_;
  }

 private:
  void line(const char* key, const std::string& value, const char* doc, const std::string& allowed);

  std::string path_;
  bool row_;
  std::string keys_;
  std::string sections_;
};

/// Throws InputError. `name` stands for the file in errors.
template <class C>
[[nodiscard]] C parseConfig(std::string_view text, const std::string& name) {
  C config{};
  ConfigReader::readStruct(TomlFile::parse(text, name).root(), config);
  return config;
}

/// Throws InputError if the file cannot be read or is wrong.
template <class C>
[[nodiscard]] C loadConfig(const std::filesystem::path& path) {
  C config{};
  ConfigReader::readStruct(TomlFile::load(path).root(), config);
  return config;
}

/// The effective config as TOML: every key, its documentation and its allowed range as comments.
template <class C>
[[nodiscard]] std::string dumpConfig(const C& config) {
  C copy = config;  // fields() is one list for reading and writing, so it takes a non-const struct
  ConfigWriter writer{std::string()};
  copy.fields(writer);
  return writer.text();
}

}  // namespace tautline
