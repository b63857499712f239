#pragma once

/// @file
/// Strict reading of TOML files. Everything that is wrong becomes one InputError that names the
/// file, the line, the dotted key (`waypoints[3].contact`), the value found, what is allowed, and
/// the remedy. The parser (toml++) is an implementation detail of toml_file.cpp: no header of the
/// project includes it.
///
///     TomlFile file = TomlFile::load("room.scene.toml");
///     TomlTable root = file.root();
///     root.require("name", name);
///     root.read("floor_m", floor, Range{-10, 10});        // optional: keeps its value when the
///     key is missing for (TomlTable& box : root.tables("boxes")) { …; box.finish(); }
///     root.finish();                                      // every key that nobody asked for is an
///     error
///
/// Numbers are finite; NaN and infinity are refused. An integer is accepted where a real number is
/// expected, not the other way round. Not real-time safe: start-up only.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "common/error.h"
#include "common/fields.h"

namespace tautline {

class TomlTable;

/// The bytes of a file. Throws InputError if it cannot be read.
[[nodiscard]] std::string readTextFile(const std::filesystem::path& path);

/// A parsed document. Copies share it; tables keep it alive.
class TomlFile {
 public:
  /// Throws InputError if the file cannot be read or is not TOML.
  [[nodiscard]] static TomlFile load(const std::filesystem::path& path);

  /// `name` stands for the file in errors.
  [[nodiscard]] static TomlFile parse(std::string_view text, const std::string& name);

  [[nodiscard]] TomlTable root() const;
  [[nodiscard]] const std::string& name() const noexcept;

  /// Line of a dotted key such as "filter.rate_hz" or "waypoints[3].contact", or of its nearest
  /// existing parent; 0 for the root.
  [[nodiscard]] int lineOf(std::string_view dotted_key) const;

  /// The same error with what it lacks of file name and line filled in: for checks that know only
  /// the key.
  [[nodiscard]] InputError locate(const InputError& error) const;

 private:
  friend class TomlTable;
  struct Impl;
  explicit TomlFile(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

/// One table of a document. Remembers the keys it was asked for; finish() refuses the others.
class TomlTable {
 public:
  /// Reads an optional key. Returns false and leaves `value` alone if the key is missing; throws
  /// InputError if it is there and wrong. A Range applies to every component of a vector.
  bool read(std::string_view key, double& value, Range range = {});
  bool read(std::string_view key, int& value, Range range = {});
  bool read(std::string_view key, bool& value);
  bool read(std::string_view key, std::string& value);
  bool read(std::string_view key, Eigen::Vector3d& value, Range range = {});

  /// Array of two-component arrays, `[[a, b], …]`.
  bool read(std::string_view key, std::vector<Eigen::Vector2d>& value, Range range = {});

  /// Array of numbers, any length, `[a, b, …]`.
  bool read(std::string_view key, std::vector<double>& value, Range range = {});

  /// Array of arrays of numbers, `[[a, b, …], [c], …]`; rows of any length, equal or not.
  bool read(std::string_view key, std::vector<std::vector<double>>& value, Range range = {});

  /// One of `names`; `index` is its position there.
  bool readChoice(std::string_view key, const std::vector<const char*>& names, std::size_t& index);

  /// As read(), but a missing key is an error.
  template <class T>
  void require(std::string_view key, T& value) {
    if (!read(key, value)) throw missing(key);
  }
  template <class T>
  void require(std::string_view key, T& value, Range range) {
    if (!read(key, value, range)) throw missing(key);
  }

  /// The tables below `key`: none if missing, one for `[key]`. Throws if it is anything but a
  /// table.
  [[nodiscard]] std::vector<TomlTable> table(std::string_view key);

  /// The tables of an array of tables `[[key]]`, in order; none if missing.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key);

  /// True if the key is there, whatever it is.
  [[nodiscard]] bool has(std::string_view key) const;

  /// Keys of this table that are tables, in alphabetic order: for files whose tables have names of
  /// their own.
  [[nodiscard]] std::vector<std::string> tableNames() const;

  /// Throws for the first key that nobody asked for, with the nearest known key as remedy.
  void finish() const;

  /// An error about `key` of this table, with its line; an empty key means the table itself.
  [[nodiscard]] InputError error(std::string_view key, std::string problem,
                                 std::string allowed = {}, std::string remedy = {}) const;

  /// TomlFile::locate() for an error whose key is relative to this table.
  [[nodiscard]] InputError locate(const InputError& error) const;

  /// Dotted path of this table; empty for the root.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  friend class TomlFile;
  TomlTable(TomlFile file, const void* table, std::string path)
      : file_(std::move(file)), table_(table), path_(std::move(path)) {}

  [[nodiscard]] std::string pathOf(std::string_view key) const;
  [[nodiscard]] InputError missing(std::string_view key) const;
  const void* find(std::string_view key);
  [[nodiscard]] std::vector<double> numbers(const std::string& key, const void* array,
                                            Range range) const;

  TomlFile file_;
  const void* table_;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace tautline
