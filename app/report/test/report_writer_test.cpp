#include "app/report/report_writer.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/report/report_text.h"
#include "app/report/test/synthetic_flight.h"
#include "common/error.h"

namespace tautline::report {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

fs::path folder() {
  const auto path = fs::path(::testing::TempDir()) / "tautline_report_writer_test";
  fs::create_directories(path);
  return path;
}

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

FlightLog syntheticLog(const SyntheticFlight& flight, const std::string& name) {
  writeSyntheticLog(flight, folder() / name);
  return readFlightLog(folder() / name);
}

TEST(ReportWriter, WritesEverythingAndLeavesNothingElse) {
  const FlightLog log = syntheticLog({.wobble = 0.12}, "complete.lcm");
  const auto target = folder() / "complete_report";
  fs::remove_all(target);
  const auto files = writeReport(log, analyze(log), nullptr, target);
  EXPECT_EQ(files.front(), target / "report.html");
  for (const char* name : {"report.html", "report.json", "series.csv", "views.svg", "top.svg",
                           "front.svg", "side.svg", "time_series.svg", "errors.svg", "loop.svg"}) {
    EXPECT_GT(fs::file_size(target / name), 500U) << name;
  }
  for (const auto& entry : fs::directory_iterator(folder())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("complete_report.")))
        << "temporary folder left behind";
  }
  std::ofstream(target / "my_notes.txt") << "mine";
  writeReport(log, analyze(log), nullptr, target);  // a second time over the first
  EXPECT_EQ(contents(target / "my_notes.txt"), "mine");
}

TEST(ReportWriter, JsonHasThePromisedKeysAndNullsForWhatIsNotKnown) {
  const FlightLog log = syntheticLog({}, "json.lcm");
  const auto json = nlohmann::json::parse(reportJson(log, analyze(log)));
  EXPECT_EQ(json.at("mode"), "SIM");
  EXPECT_EQ(json.at("mission_completed"), true);
  EXPECT_EQ(json.at("landed"), true);
  EXPECT_NEAR(json.at("cross_track_mean_m"), 0.05, 1e-9);
  EXPECT_NEAR(json.at("cross_track_max_m"), 0.05, 1e-9);
  EXPECT_NEAR(json.at("localization_mean_m"), 0.08, 1e-6);
  EXPECT_EQ(json.at("overruns"), 2);
  EXPECT_EQ(json.at("cross_track").at("segments").size(), 4U);
  EXPECT_EQ(json.at("tether").at("contact_changes").at(0).at("change"), "formed");
  EXPECT_EQ(json.at("events").at(1).at("severity"), "warning");

  const FlightLog real = syntheticLog({.lands = false, .with_truth = false}, "real.lcm");
  const auto partial = nlohmann::json::parse(reportJson(real, analyze(real)));
  EXPECT_TRUE(partial.at("localization_mean_m").is_null());
  EXPECT_TRUE(partial.at("localization").at("slope_over_length_m_per_m").is_null());
  EXPECT_TRUE(partial.at("crashed").is_null());
  EXPECT_EQ(partial.at("landed"), false);
}

TEST(ReportWriter, ThePageIsOneFileAndItsTextIsEscaped) {
  const FlightLog log = syntheticLog({}, "page.lcm");
  const auto target = folder() / "page_report";
  writeReport(log, analyze(log), nullptr, target);
  const std::string page = contents(target / "report.html");
  EXPECT_NE(page.find("Mission completed; landed."), std::string::npos)
      << "Mission completed; landed.";
  EXPECT_NE(page.find("look at the &lt;b&gt;tether&lt;/b&gt; &amp; wait"), std::string::npos)
      << "look at the &lt;b&gt;tether&lt;/b&gt; &amp; wait";
  for (const char* outside : {"<script", "<link", "src=", "@import", "url(http"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  std::size_t pictures = 0;
  for (auto at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 4U);
}

TEST(ReportWriter, CsvRowsAreAllOfTheSameWidth) {
  const FlightLog log = syntheticLog({}, "csv.lcm");
  std::istringstream csv(seriesCsv(log, analyze(log)));
  std::string line;
  std::getline(csv, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  std::size_t rows = 0;
  for (; std::getline(csv, line); ++rows)
    ASSERT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
  EXPECT_EQ(rows, log.estimates.size());
}

TEST(ReportWriter, AFolderThatCannotBeMadeIsAnError) {
  const FlightLog log = syntheticLog({}, "nowhere.lcm");
  std::ofstream(folder() / "a_file") << "x";
  EXPECT_THROW(writeReport(log, analyze(log), nullptr, folder() / "a_file" / "report"), InputError);
}

}  // namespace
}  // namespace tautline::report
