#pragma once

/// @file
/// One list of fields for each config struct. A struct names its fields once, in `fields()`;
/// reading a TOML file strictly, writing the effective config and listing the help all walk that
/// one list:
///
///     struct Config {
///       double loop_rate_hz{100.0};
///       FilterConfig filter;
///       template <class Visitor>
///       void fields(Visitor& v) {
///         v.field("loop_rate_hz", loop_rate_hz, Range{10, 1000}, "cycles a second");
///         v.section("filter", filter);
///       }
///     };
///
/// A Visitor has
///   field(key, double|int|bool|std::string|Eigen::Vector3d&, [Range,] doc)
///   field(key, FixedList<Eigen::Vector2d, N>&, Range, doc)
///   choice(key, Enum&, const std::array<EnumName<Enum>, N>&, doc)
///   section(key, Struct&)
///   rows(key, FixedList<Struct, N>&, doc)      an array of tables
/// Readers and writers live in common/toml; this header has no dependency.

#include <limits>

namespace tautline {

/// Closed interval of allowed values. Finite bounds also exclude infinity; NaN is never allowed.
struct Range {
  double min{-std::numeric_limits<double>::max()};
  double max{std::numeric_limits<double>::max()};

  [[nodiscard]] constexpr bool contains(double value) const noexcept {
    return value >= min && value <= max;  // false for NaN
  }
};

/// One value of an enumeration and its name in files and on the command line.
template <class Enum>
struct EnumName {
  Enum value;
  const char* name;
};

/// Name of `value` in `names`, or "?". Real-time safe: no allocation, no locks, no exceptions.
template <class Enum, class Names>
[[nodiscard]] constexpr const char* nameOf(Enum value, const Names& names) noexcept {
  for (const auto& entry : names) {
    if (entry.value == value) return entry.name;
  }
  return "?";
}

}  // namespace tautline
