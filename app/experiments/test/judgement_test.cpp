#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/experiments/experiments_report.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {
namespace {

Row row(std::optional<double> as_published, std::optional<Band> as_published_band,
        std::optional<double> tautline = {}, std::optional<Band> tautline_band = {}) {
  return {.figure = "f",
          .as_published = as_published,
          .tautline = tautline,
          .as_published_band = as_published_band,
          .tautline_band = tautline_band};
}

TEST(Row, PassesInsideItsBandsOnly) {
  const Band band{0.4, 0.6};
  EXPECT_TRUE(row(0.4, band).pass());
  EXPECT_TRUE(row(0.6, band).pass());
  EXPECT_FALSE(row(0.39, band).pass());
  EXPECT_FALSE(row(0.61, band).pass());
  EXPECT_FALSE(row(std::nan(""), band).pass());
  EXPECT_FALSE(row({}, band).pass()) << "a band without its figure";
  EXPECT_TRUE(row(9.0, {}).pass()) << "told, not judged";
  EXPECT_TRUE(row(-9.0, Band{.max = 0.1}).pass());
  EXPECT_FALSE(row(0.5, band, 0.2, Band{.max = 0.1}).pass()) << "both sides count";
  EXPECT_TRUE(row(0.5, band, 0.1, Band{.max = 0.1}).pass());
}

const Experiment kOne{"one", "First <of all>", "Fly, and \"look\".", nullptr, nullptr};

std::vector<Chapter> twoRows() {
  Chapter chapter{&kOne, {}};
  chapter.findings.rows = {{.figure = "error, mean",
                            .unit = "m",
                            .published = 0.5,
                            .as_published = 0.55,
                            .tautline = 0.05,
                            .as_published_band = Band{0.4, 0.6},
                            .tautline_band = Band{.max = 0.1},
                            .note = "a < b"},
                           {.figure = "share",
                            .as_published = std::numeric_limits<double>::quiet_NaN(),
                            .as_published_band = Band{.min = 1.0}}};
  chapter.findings.sheets = {{"table", {"a", "b"}, {{"1,5", "say \"x\""}}}};
  plot::Panel panel;
  panel.series.push_back({.name = "line", .points = {{0, 0}, {1, 1}}});
  chapter.findings.pictures = {{"line", "A line & more", {.panels = {panel}}}};
  return {chapter};
}

TEST(Report, CountsWhatPasses) {
  std::vector<Chapter> chapters = twoRows();
  EXPECT_EQ(tally(chapters).rows(), 2);
  EXPECT_EQ(tally(chapters).passed, 1);
  EXPECT_EQ(tally(chapters).failed, 1);
  for (Row& r : chapters[0].findings.rows) r.shortfall = "air";
  EXPECT_EQ(tally(chapters).failed, 1) << "no reason explains what is not a number";
  chapters[0].findings.rows[1].as_published = 0.7;
  EXPECT_EQ(tally(chapters).passed, 1) << "a goal that is met after all";
  EXPECT_EQ(tally(chapters).short_of, 1);
  EXPECT_EQ(tally(chapters).failed, 0);
  Row& bad = chapters[0].findings.rows[1];
  bad.as_published = 0.5;
  bad.shortfall_limit = Band{.min = 0.6};
  EXPECT_EQ(tally(chapters).failed, 1) << "worse than the reason explains";
}

TEST(Report, JsonHasTheContractsKeys) {
  const nlohmann::json rows = nlohmann::json::parse(reportJson(twoRows()));
  ASSERT_EQ(rows.size(), 2U);
  for (const nlohmann::json& r : rows)
    for (const char* key :
         {"experiment", "figure", "published", "as_published", "tautline", "band", "pass"})
      EXPECT_TRUE(r.contains(key)) << key;
  EXPECT_EQ(rows[0].at("experiment"), "one");
  EXPECT_DOUBLE_EQ(rows[0].at("as_published"), 0.55);
  EXPECT_EQ(rows[0].at("band").at("as_published"), nlohmann::json({0.4, 0.6}));
  EXPECT_EQ(rows[0].at("band").at("tautline"), nlohmann::json({nullptr, 0.1})) << "no lower end";
  EXPECT_EQ(rows[0].at("pass"), true);
  EXPECT_TRUE(rows[1].at("published").is_null());
  EXPECT_TRUE(rows[1].at("as_published").is_null()) << "not a number";
  EXPECT_TRUE(rows[1].at("band").at("tautline").is_null());
  EXPECT_EQ(rows[1].at("pass"), false);
}

TEST(Report, WritesAllFilesWithTextQuoted) {
  const auto folder = std::filesystem::temp_directory_path() / "tautline_experiments_report";
  std::filesystem::remove_all(folder);
  const experiments::Setup setup{
      .folder = {}, .quick = true, .seed = 7, .plant = {}, .as_published = {}, .tautline = {}};
  const auto page = writeReport(setup, twoRows(), folder);
  EXPECT_EQ(page.filename(), "report.html");
  const std::string html = readTextFile(page);
  EXPECT_NE(html.find("First &lt;of all&gt;"), std::string::npos);
  EXPECT_NE(html.find("a &lt; b"), std::string::npos);
  EXPECT_NE(html.find("1 of 2 rows pass"), std::string::npos);
  EXPECT_NE(html.find("quick sample"), std::string::npos);
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_EQ(readTextFile(folder / "one_table.csv"), "a,b\n\"1,5\",\"say \"\"x\"\"\"\n");
  EXPECT_NE(readTextFile(folder / "report.csv")
                .find("one,\"error, mean\",m,0.5,0.55,0.05,0.4,0.6,,0.1,1\n"),
            std::string::npos)
      << readTextFile(folder / "report.csv");
  const std::string markdown = readTextFile(folder / "report.md");
  EXPECT_NE(
      markdown.find(
          "| error, mean [m] | 0.5 | 0.55 | 0.05 | as published 0.4 … 0.6; Tautline ≤ 0.1 | yes |"),
      std::string::npos)
      << markdown;
  EXPECT_TRUE(std::filesystem::exists(folder / "one_line.svg"));
  EXPECT_EQ(nlohmann::json::parse(readTextFile(folder / "report.json")).size(), 2U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tautline::experiments
