#pragma once

/// @file
/// Parameters of the core that can be changed while the station runs, in STANDBY only: the numbers
/// of the sections below. A parameter is addressed by the hash of its key, so that client and
/// station need not be of one version. Not live: `core.control` (its law is made at start-up),
/// texts, choices, vectors and rows, and everything outside `core`.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/fields.h"

namespace tautline {

/// FNV-1a of a dotted key, e.g. "core.guidance.takeoff_height_m". Real-time safe: no allocation, no
/// locks, no exceptions.
[[nodiscard]] constexpr std::uint64_t parameterHash(std::string_view key) noexcept {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

/// A key of at most 95 characters, ended with zero.
struct ParameterKey {
  std::array<char, 96> text{};
  std::size_t size{0};

  /// Real-time safe: no allocation, no locks, no exceptions.
  constexpr void append(std::string_view part) noexcept {
    if (size != 0 && size + 1 < text.size()) text[size++] = '.';
    const std::size_t room = std::min(part.size(), text.size() - 1 - size);
    std::copy_n(part.begin(), room, text.begin() + static_cast<std::ptrdiff_t>(size));
    size += room;
  }
  [[nodiscard]] constexpr std::string_view view() const noexcept { return {text.data(), size}; }
};

/// A change that was made.
struct ParameterChange {
  ParameterKey key;
  double before{0.0};
  double after{0.0};
  bool integer{false};
};

inline constexpr std::array kLiveSections{
    std::string_view{"guidance"},   std::string_view{"localizer"},
    std::string_view{"detect"},     std::string_view{"fence"},
    std::string_view{"supervisor"}, std::string_view{"authority"},
    std::string_view{"executor"},   std::string_view{"limits"},
    std::string_view{"gate"},       std::string_view{"reel_dead_zone"}};

/// Whether the number with this dotted key can be changed while the station runs.
[[nodiscard]] constexpr bool isLive(std::string_view key) noexcept {
  constexpr std::string_view kCore = "core.";
  if (key.substr(0, kCore.size()) != kCore) return false;
  key.remove_prefix(kCore.size());
  const std::size_t dot = key.find('.');
  return dot == std::string_view::npos || std::find(kLiveSections.begin(), kLiveSections.end(),
                                                    key.substr(0, dot)) != kLiveSections.end();
}

/// Visitor of common/fields.h over the core's configuration that sets one number. Real-time safe:
/// no allocation, no locks, no exceptions.
class ParameterSetter {
 public:
  ParameterSetter(std::uint64_t hash, double value) noexcept : hash_(hash), value_(value) {
    key_.append("core");
  }

  void field(const char* key, double& target, Range range, const char* /*doc*/) noexcept {
    if (found(key)) set(target, range, false);
  }
  void field(const char* key, int& target, Range range, const char* /*doc*/) noexcept {
    if (!found(key) || value_ != std::floor(value_)) return;
    double number = target;
    set(number, range, true);
    target = static_cast<int>(number);
  }
  template <class T>
  void field(const char* /*key*/, T& /*target*/, Range /*range*/, const char* /*doc*/) noexcept {}
  template <class T>
  void field(const char* /*key*/, T& /*target*/, const char* /*doc*/) noexcept {}
  template <class Enum, class Names>
  void choice(const char* /*key*/, Enum& /*target*/, const Names&, const char* /*doc*/) noexcept {}
  template <class Rows>
  void rows(const char* /*key*/, Rows& /*rows*/, const char* /*doc*/) noexcept {}
  template <class Struct>
  void section(const char* key, Struct& inner) noexcept {
    const ParameterKey before = key_;
    key_.append(key);
    inner.fields(*this);
    key_ = before;
  }

  /// What was set, or none: no such parameter, or a value out of its range.
  [[nodiscard]] const std::optional<ParameterChange>& change() const noexcept { return change_; }

 private:
  [[nodiscard]] bool found(const char* key) noexcept {
    ParameterKey whole = key_;
    whole.append(key);
    if (parameterHash(whole.view()) != hash_ || !isLive(whole.view())) return false;
    found_ = whole;
    return true;
  }
  void set(double& target, Range range, bool integer) noexcept {
    if (!range.contains(value_)) return;
    change_ = ParameterChange{found_, target, value_, integer};
    target = value_;
  }

  std::uint64_t hash_;
  double value_;
  ParameterKey key_;
  ParameterKey found_;
  std::optional<ParameterChange> change_;
};

}  // namespace tautline
