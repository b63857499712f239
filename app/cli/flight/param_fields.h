#pragma once

/// @file
/// Every field of the station's configuration with its value as text, for people; read off the one
/// list of fields (common/fields.h). Not real-time safe.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "app/station/live_parameters.h"
#include "common/toml/toml_writer.h"

namespace tautline::cli::flight {

struct ParamField {
  std::string key;
  std::string value;  ///< As in TOML.
  std::string allowed;
  std::string doc;
  std::optional<Range> range;  ///< Of a number.
  bool integer{false};
  bool live{false};  ///< `param set` can change it.
};

/// Visitor that lists the fields.
class FieldLister {
 public:
  explicit FieldLister(std::string path = {}) : path_(std::move(path)) {}

  void field(const char* key, double& value, Range range, const char* doc) {
    number(key, tomlText(value), range, false, doc);
  }
  void field(const char* key, int& value, Range range, const char* doc) {
    number(key, tomlText(value), range, true, doc);
  }
  template <class T>
  void field(const char* key, T& value, Range range, const char* doc) {
    add(key, text(value), rangeText(range), doc);
  }
  template <class T>
  void field(const char* key, T& value, const char* doc) {
    add(key, text(value), "", doc);
  }
  template <class Enum, class Names>
  void choice(const char* key, Enum& value, const Names& names, const char* doc) {
    std::string allowed;
    for (const auto& entry : names)
      allowed += (allowed.empty() ? "" : ", ") + std::string(entry.name);
    add(key, tomlText(std::string(nameOf(value, names))), allowed, doc);
  }
  template <class Rows>
  void rows(const char* key, Rows& rows, const char* doc) {
    add(key, std::to_string(rows.all().size()) + " rows", "", doc);
  }
  template <class Struct>
  void section(const char* key, Struct& inner) {
    FieldLister lister(pathOf(key));
    inner.fields(lister);
    all_.insert(all_.end(), lister.all_.begin(), lister.all_.end());
  }

  [[nodiscard]] const std::vector<ParamField>& all() const { return all_; }

 private:
  [[nodiscard]] std::string pathOf(const char* key) const {
    return path_.empty() ? key : path_ + "." + key;
  }
  template <class T>
  static std::string text(T& value) {
    if constexpr (requires { tomlText(value); }) return tomlText(value);
    return "…";
  }
  void add(const char* key, std::string value, std::string allowed, const char* doc) {
    all_.push_back({pathOf(key), std::move(value), std::move(allowed), doc, {}, false, false});
  }
  void number(const char* key, std::string value, Range range, bool integer, const char* doc) {
    add(key, std::move(value), rangeText(range), doc);
    all_.back().range = range;
    all_.back().integer = integer;
    all_.back().live = isLive(all_.back().key);
  }

  std::string path_;
  std::vector<ParamField> all_;
};

/// All fields of `config`, in its order.
template <class Config>
[[nodiscard]] std::vector<ParamField> fieldsOf(Config config) {
  FieldLister lister;
  config.fields(lister);
  return lister.all();
}

}  // namespace tautline::cli::flight
