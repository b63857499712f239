#pragma once

/// @file
/// One flight of the bench with everything that is to happen in it and everything that is expected
/// of it: what scenario files and the safety campaign are made of. Modes, conditions and events go
/// by their names in the station's own tables.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/bench/lockstep.h"
#include "common/toml/toml_file.h"
#include "sim_hil/fault_file.h"

namespace tautline::bench {

/// A set of modes; bit i is Mode i.
class ModeSet {
 public:
  void add(Mode mode) noexcept { bits_ |= bit(mode); }
  [[nodiscard]] bool has(Mode mode) const noexcept { return (bits_ & bit(mode)) != 0; }
  [[nodiscard]] bool empty() const noexcept { return bits_ == 0; }
  friend bool operator==(ModeSet a, ModeSet b) noexcept = default;
  friend ModeSet operator|(ModeSet a, ModeSet b) noexcept {
    a.bits_ |= b.bits_;
    return a;
  }
  [[nodiscard]] std::string text() const;

 private:
  static std::uint32_t bit(Mode mode) noexcept { return 1U << static_cast<unsigned>(mode); }
  std::uint32_t bits_{0};
};

/// A moment that times count from: the run's start, the first cycle in a mode, the first cycle with
/// a condition, or the beginning of the first fault.
struct Phase {
  enum class Kind : std::uint8_t { kStart, kMode, kCondition, kFault };
  Kind kind{Kind::kStart};
  Mode mode{};
  Condition condition{};
};

/// What an operator does, once, `at` after the beginning of the phase; or, with `in_mode`, whenever
/// the station has been in that mode for so long: asks for something, or moves the sticks and holds
/// them so.
struct OperatorEntry {
  Phase phase;
  bool in_mode{false};
  Duration at{};
  Request verb{Request::kNone};
  Duration retry{};                   ///< Asks again for so long while it is refused.
  std::optional<TeleopRates> sticks;  ///< Absent: left as they are.
};

/// A fault, `fault.at` after the beginning of the phase.
struct FaultPlan {
  Phase phase;
  sim::Fault fault;
};

/// What can be bounded, by its name in files.
struct Quantity {
  const char* name;
  double (*of)(const Rig& rig);
};

/// What has to be seen between `after` and `after + within` from the beginning of the phase.
struct Expectation {
  enum class Kind : std::uint8_t { kMode, kCondition, kClear, kEvent, kBound };
  Phase phase;
  Duration after{};
  Duration within{};
  Kind kind{Kind::kMode};
  ModeSet modes;                      ///< kMode: one of these.
  ConditionSet conditions;            ///< kCondition: any of these; kClear: none of these.
  EventCode event{};                  ///< kEvent
  const Quantity* quantity{nullptr};  ///< kBound: within `range` all the time.
  Range range;
  [[nodiscard]] std::string text() const;
};

/// Modes that may follow each other; nothing is checked if there are none.
struct ModeSequence {
  Mode from{};
  ModeSet to;
};

/// What holds all the time, or at the end.
struct CaseLimits {
  bool may_crash{false};
  double max_height_m{1e9};  ///< Over the floor.
  double stale_s{0.7};       ///< No rates later than this after the last length or angles.
  ModeSet end;               ///< The run ends in one of these; empty: anywhere.
  bool landed{false};        ///< It ends on the ground, motors off.
  std::vector<ModeSequence> sequence;
};

struct FlightCase {
  std::string name;
  LockstepConfig bench;
  std::shared_ptr<const MissionPlan> mission;  ///< Null: none is navigated.
  Duration limit{};                            ///< Of virtual time.
  std::vector<OperatorEntry> script;
  std::vector<FaultPlan> faults;
  std::vector<Expectation> expectations;
  CaseLimits limits;
};

/// Reading of names. All throw InputError that lists what there is.
[[nodiscard]] ModeSet readModes(TomlTable& table, const char* key);    ///< Separated by blanks.
[[nodiscard]] Request readRequest(TomlTable& table, const char* key);  ///< kNone if missing.
[[nodiscard]] ConditionSet readConditions(TomlTable& table, const char* key);  ///< The same.
[[nodiscard]] Phase parsePhase(const TomlTable& table, const std::string& text);
[[nodiscard]] std::vector<OperatorEntry> readScript(TomlTable& root);
[[nodiscard]] std::vector<ModeSequence> readSequence(TomlTable& root);
[[nodiscard]] FaultPlan planFault(const TomlTable& table, const sim::FaultEntry& entry);
[[nodiscard]] Expectation readExpectation(TomlTable& table);

/// Scene, start and mission of a flight, as its file names them: paths relative to that file.
/// `obstacles` of the table are in the world and in no map.
void readSurroundings(TomlTable& table, const std::string& file, FlightCase& flight);

/// A scenario file as one case (docs/fault_campaign.md). Throws InputError.
[[nodiscard]] FlightCase readScenario(const std::string& file);

}  // namespace tautline::bench
