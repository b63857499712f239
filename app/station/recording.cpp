#include "app/station/recording.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <numbers>
#include <string>

#include <tautline/station_input_t.hpp>

#include "app/log/event_log_reader.h"
#include "app/log/log_version.h"
#include "app/station/input_message.h"
#include "common/error.h"
#include "common/tether_geometry.h"
#include "drivers/flight_log_codec.h"
#include "lcmtypes/channels.h"

namespace tautline {
namespace {

constexpr double kFlying = 0.05;       // a tether shorter than this is not out [m]
constexpr double kAtReel = 0.02;       // a contact this near the origin is the reel [m]
constexpr double kLogScale = 0.00406;  // of the machine that wrote the text logs [m per count]

Recording readLcmLog(const std::filesystem::path& file) {
  EventLogReader log(file);
  Recording out;
  LogVersion version;
  while (const auto event = log.next()) {
    tautline::station_input_t input;
    if (event->channel != channel::kStationInput ||
        !version.fits<tautline::station_input_t>(*event) ||
        input.decode(event->data.data(), 0, static_cast<int>(event->data.size())) < 0)
      continue;
    StepInput in = inputOf(input);
    if (!out.cycles.empty() && in.now <= out.cycles.back().now) continue;
    out.cycles.push_back({in.now, in.sensors});
  }
  version.check(file);
  return out;
}

std::vector<std::string> readLines(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Nothing in a row says which layout it has: it is the one in which positions follow from length
/// and angles.
FlightLogLayout layoutOf(const std::vector<std::string>& lines) {
  constexpr double kFollows = 0.02;  // [m]; the reel stands a little beside the origin
  const auto fitting = [&](FlightLogLayout layout) {
    return std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
      const ParsedFlightLogRow parsed = parseFlightLogRow(line, layout);
      if (parsed.error != FlightLogError::kNone) return false;
      const FlightLogRow& row = parsed.row;
      const Eigen::Vector3d p =
          toCartesian({row.length, row.elevation, row.azimuth + std::numbers::pi / 2.0});
      return row.length > kFlying && (row.p_WD - p).norm() < kFollows;
    });
  };
  return fitting(FlightLogLayout::kPositionLast) > fitting(FlightLogLayout::kPositionFirst)
             ? FlightLogLayout::kPositionLast
             : FlightLogLayout::kPositionFirst;
}

/// The rows of one flight, without those before the tether was out.
std::vector<FlightLogRow> readRows(const std::filesystem::path& file, Recording& counts) {
  const std::vector<std::string> lines = readLines(file);
  const FlightLogLayout layout = layoutOf(lines);
  std::vector<FlightLogRow> rows;
  for (const std::string& line : lines) {
    const ParsedFlightLogRow parsed = parseFlightLogRow(line, layout);
    const bool good = parsed.error == FlightLogError::kNone && parsed.row.length > kFlying &&
                      (rows.empty() || parsed.row.second >= rows.back().second);
    if (good) rows.push_back(parsed.row);
    counts.skipped += good ? 0 : 1;
    counts.uninitialized += parsed.error == FlightLogError::kUninitialized ? 1 : 0;
  }
  return rows;
}

/// The log has the last contact only; the tether along those before it is what its program left of
/// the length for the drone, never less than the straight line.
Anchor anchorOf(const FlightLogRow& row) {
  const double distance = row.p_WA.norm();
  if (distance < kAtReel) return {};
  const double along = row.length - (row.p_WD - row.p_WA).norm();
  return {.p_WA = row.p_WA, .L_static = std::max(distance, along), .contact_count = 1};
}

/// Rows of one second are spread over it evenly: their stamps have whole seconds. A value that
/// changes is a new sample, and so is the first row of each second: the machine sent about one a
/// second, whether or not it had moved.
Recording readTextLog(const std::filesystem::path& file) {
  Recording out;
  const std::vector<FlightLogRow> rows = readRows(file, out);
  SensorFrame frame;
  frame.link.connected = true;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    while (end < rows.size() && rows[end].second == rows[i].second) ++end;
    for (std::size_t k = i; k < end; ++k) {
      const FlightLogRow& row = rows[k];
      const double part = static_cast<double>(k - i) / static_cast<double>(end - i);
      const Time now =
          Time{} + std::chrono::seconds(row.second - rows.front().second + 1) + fromSeconds(part);
      const Anchor anchor = anchorOf(row);
      const double length = row.length;
      const double phi = wrapAngle(row.azimuth + std::numbers::pi / 2.0);
      const bool first = k == i;
      if (first || frame.reel.value.length != length) {
        update(
            frame.reel, now,
            ReelReading{.counts = length / kLogScale, .length = length, .tension = std::nullopt});
      }
      if (first || frame.angles.value.theta != row.elevation || frame.angles.value.phi != phi) {
        update(frame.angles, now,
               TetherAngles{.theta = row.elevation, .phi = phi, .altitude = std::nullopt});
      }
      if (first)
        update(frame.vehicle, now,
               VehicleReading{.phase = VehiclePhase::kFlying,
                              .flight_mode = 0,
                              .flags = 0,
                              .backup_battery_voltage = 0.0});
      out.cycles.push_back({now, frame});
      out.poses.push_back({anchor, row.p_WD, row});
    }
    i = end;
  }
  return out;
}

}  // namespace

bool isLcmLog(const std::filesystem::path& file) {
  constexpr std::array<char, 4> kMark{'\xED', '\xA1', '\xDA', '\x01'};
  std::ifstream in(file, std::ios::binary);
  std::array<char, 4> first{};
  if (!in.read(first.data(), first.size())) {
    throw InputError({.file = file.string(),
                      .problem = "cannot be read, or is empty",
                      .remedy = "name an LCM log or a flight log"});
  }
  return first == kMark;
}

Recording readRecording(const std::filesystem::path& file) {
  const bool is_lcm = isLcmLog(file);
  Recording out = is_lcm ? readLcmLog(file) : readTextLog(file);
  if (out.cycles.empty()) {
    throw InputError({.file = file.string(),
                      .problem = is_lcm ? "has no STATION_INPUT messages"
                                        : "has no row of a flight log (22 or 19 numbers)",
                      .remedy = "record all channels with lcm-logger, or name a flight log"});
  }
  return out;
}

}  // namespace tautline
