#include "app/cli/flight/stick_script.h"

#include <fstream>
#include <sstream>

#include "common/error.h"

namespace tautline::cli::flight {

std::vector<StickRow> readStickScript(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw InputError({.file = file, .problem = "cannot be read"});
  std::vector<StickRow> rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    double seconds = 0.0;
    int dead_man = 0;
    StickRow row;
    TeleopRates& r = row.rates;
    std::string rest;
    words >> seconds >> dead_man >> r.length >> r.elevation >> r.azimuth >> r.yaw >> r.gimbal_pitch;
    const bool complete = !words.fail() && !(words >> rest);
    if (!complete || !Range{0.0, 3600.0}.contains(seconds) || (dead_man != 0 && dead_man != 1)) {
      throw InputError({.file = file,
                        .line = number,
                        .problem = "is no row of stick rates",
                        .allowed = "seconds (0 to 3600), dead man 0 or 1, and five rates: length "
                                   "m/s, elevation, azimuth, yaw, gimbal rad/s"});
    }
    row.lasts = fromSeconds(seconds);
    row.dead_man = dead_man == 1;
    rows.push_back(row);
  }
  return rows;
}

std::optional<StickRow> rowAt(const std::vector<StickRow>& rows, Duration since_start) {
  for (const StickRow& row : rows) {
    if (since_start < row.lasts) return row;
    since_start -= row.lasts;
  }
  return std::nullopt;
}

}  // namespace tautline::cli::flight
