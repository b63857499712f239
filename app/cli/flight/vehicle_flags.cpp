#include "app/cli/flight/vehicle_flags.h"

#include <fmt/format.h>

#include "app/station/station_config.h"
#include "common/toml/config_file.h"
#include "drivers/fotokite_protocol.h"
#include "drivers/tautline_protocol.h"

namespace tautline::cli::flight {
namespace {

template <class Names>
std::vector<std::string> namesIn(int flags, const Names& names) {
  std::vector<std::string> out;
  for (const auto& entry : names) {
    if ((flags & entry.value) != 0) out.emplace_back(entry.name);
    flags &= ~entry.value;
  }
  if (flags != 0) out.push_back(fmt::format("{:#x}", flags));
  return out;
}

}  // namespace

std::vector<std::string> flagNames(const StationClient::View& v) {
  const int flags = v.vehicle->flags;
  if (flags == 0) return {};
  if (!v.params) return {fmt::format("{:#x}", flags)};
  switch (parseConfig<StationConfig>(v.params->toml, "PARAMS").device) {
    case DeviceKind::kTautlineCan:
    case DeviceKind::kTautlineSerial:
      return namesIn(flags, bus::kVehicleFlagNames);
    case DeviceKind::kFotokite:
    case DeviceKind::kReplay:
      break;
  }
  return namesIn(flags, fotokite::kFlightFlagNames);
}

}  // namespace tautline::cli::flight
