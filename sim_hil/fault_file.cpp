#include "sim_hil/fault_file.h"

namespace tautline::sim {

FaultEntry readFault(TomlTable& table) {
  FaultEntry entry;
  std::string target;
  std::string mode;
  double at_s = 0.0;
  double for_s = 0.0;
  table.require("target", target);
  table.require("mode", mode);
  try {
    entry.fault = makeFault(target, mode);
  } catch (const InputError& e) {
    throw table.locate(e);
  }
  table.read("phase", entry.phase);
  table.read("at_s", at_s, Range{0, 1e5});
  table.read("for_s", for_s, Range{0, 1e5});
  table.read("value", entry.fault.value);
  table.read("velocity_mps", entry.fault.velocity, Range{-20, 20});
  entry.fault.at = Time{} + fromSeconds(at_s);
  if (for_s > 0.0) entry.fault.lasting = fromSeconds(for_s);
  return entry;
}

std::vector<FaultEntry> readFaults(TomlTable& root) {
  std::vector<FaultEntry> entries;
  for (TomlTable& table : root.tables("fault")) {
    entries.push_back(readFault(table));
    table.finish();
  }
  return entries;
}

}  // namespace tautline::sim
