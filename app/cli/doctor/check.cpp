#include "app/cli/doctor/check.h"

#include <sys/timex.h>

#include <fstream>

#include "app/cli/doctor/latency.h"
#include "app/cli/doctor/real_time_checks.h"
#include "app/cli/doctor/station_checks.h"
#include "app/station/station_config.h"
#include "common/toml/config_file.h"

namespace tautline::cli {

const std::vector<Check>& allChecks() {
  using enum CheckGroup;
  static const std::vector<Check> checks{
      {"CONFIG", kStation, checkConfig},
      {"SERIAL_PORT", kStation, checkSerialPort},
      {"CAN", kStation, checkCan},
      {"MULTICAST", kNetwork, checkMulticast},
      {"STATION", kNetwork, checkStationHeard},
      {"LOG_DISK", kDisk, checkLogDisk},
      {"BLACK_BOX_DISK", kDisk, checkBlackBoxDisk},
      {"RT_PRIORITY", kRealTime, checkPriority},
      {"MEMLOCK", kRealTime, checkMemlock},
      {"KERNEL", kRealTime, checkKernel},
      {"GOVERNOR", kRealTime, checkGovernor},
      {"CLOCK_SOURCE", kRealTime, checkClockSource},
      {"CLOCK_SYNC", kRealTime, checkClockSynchronized},
      {"ISOLATED_CPU", kRealTime, checkIsolatedCpus},
      {"LATENCY", kRealTime, checkLatency},
  };
  return checks;
}

Machine thisMachine() {
  Machine machine;
  machine.clock_synchronized = [] {
    timex state{};
    return adjtimex(&state) >= 0 && (state.status & STA_UNSYNC) == 0;
  };
  machine.lateness = measureLateness;
  return machine;
}

void readStationConfig(Machine& machine, const std::filesystem::path& file) {
  machine.config_file = file;
  try {
    machine.config = std::make_shared<const StationConfig>(loadConfig<StationConfig>(file));
  } catch (const InputError& error) {
    machine.config_problem = error.what();
  }
}

std::string firstLine(const Machine& machine, const std::string& path) {
  std::ifstream in(machine.root / path);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace tautline::cli
