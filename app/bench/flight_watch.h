#pragma once

/// @file
/// What has to hold in every cycle of every flight, whatever is wrong with the machine. Stated from
/// outside, by what the bench sees, and not with the station's own conditions.

#include <array>
#include <optional>
#include <set>
#include <string>

#include "app/bench/flight_case.h"

namespace tautline::bench {

class FlightWatch {
 public:
  explicit FlightWatch(const CaseLimits& limits) : limits_(limits) {}

  /// An operator has asked to fly the mission with this command.
  void navigateAsked(std::int64_t sequence) { navigate_sequences_.insert(sequence); }

  /// After every cycle; returns what is wrong in it, once each.
  [[nodiscard]] std::optional<std::string> check(const Rig& rig);

 private:
  /// Arrivals of one stream, as the bench sees them.
  struct Stream {
    std::uint32_t sequence{0};
    Time arrived{};
    std::array<double, 4> gaps{};  ///< Last times between two samples [s].
    std::size_t next{0};
    void see(std::uint32_t now_sequence, Time now) noexcept;
    [[nodiscard]] double limit(double least) const noexcept;
  };

  [[nodiscard]] std::optional<std::string> checkFinite(const Rig& rig) const;
  [[nodiscard]] std::optional<std::string> checkRates(const Rig& rig);
  [[nodiscard]] std::optional<std::string> checkModes(const Rig& rig);
  [[nodiscard]] std::optional<std::string> checkMachine(const Rig& rig) const;

  CaseLimits limits_;
  std::set<std::int64_t> navigate_sequences_;
  Mode mode_{Mode::kStandby};
  Stream reel_;
  Stream angles_;
};

}  // namespace tautline::bench
