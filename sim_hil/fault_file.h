#pragma once

/// @file
/// Faults in a scenario file: [[fault]] tables.

#include <string>
#include <vector>

#include "common/toml/toml_file.h"
#include "sim_hil/fault.h"

namespace tautline::sim {

/// A fault whose time counts from something that only the reader of the file knows.
struct FaultEntry {
  Fault fault;        ///< `at` from Time{} on, or from the beginning of the phase.
  std::string phase;  ///< Empty: the run's start.
};

/// The keys of one fault: target, mode, phase, at_s, for_s (0: for ever), value, velocity_mps.
/// Throws InputError. Not real-time safe: start-up only.
[[nodiscard]] FaultEntry readFault(TomlTable& table);

/// All [[fault]] tables of a file. Throws InputError. Not real-time safe: start-up only.
[[nodiscard]] std::vector<FaultEntry> readFaults(TomlTable& root);

}  // namespace tautline::sim
