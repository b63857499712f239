#include "app/experiments/experiments_report.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/report/html.h"
#include "app/report/output_folder.h"
#include "common/markup.h"

namespace tautline::experiments {
namespace {

using nlohmann::json;

constexpr const char* kNothing = "–";

json jsonOf(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? json(*value) : json(nullptr);
}

json jsonOf(const std::optional<Band>& band) {
  return band ? json{jsonOf(std::optional(band->min)), jsonOf(std::optional(band->max))}
              : json(nullptr);
}

std::string show(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : kNothing;
}

std::string show(const Band& band) {
  if (std::isinf(band.min)) return fmt::format("≤ {:g}", band.max);
  if (std::isinf(band.max)) return fmt::format("≥ {:g}", band.min);
  return fmt::format("{:g} … {:g}", band.min, band.max);
}

/// "as published 0.4 … 0.6; Tautline ≤ 0.05"
std::string bandText(const Row& row) {
  std::string text;
  if (row.as_published_band) text = "as published " + show(*row.as_published_band);
  if (row.tautline_band) {
    text += (text.empty() ? "" : "; ") + std::string("Tautline ") + show(*row.tautline_band);
  }
  return text.empty() ? kNothing : text;
}

std::string figureText(const Row& row) {
  return row.figure + (row.unit.empty() ? "" : " [" + row.unit + "]");
}

const std::vector<std::string> kColumns{
    "<figure", "published", "as published, simulated", "Tautline, simulated", "<band",
    "<pass",   "<note"};

std::string passText(const Row& row) {
  return row.pass() ? "yes" : row.fallsShort() ? "falls short" : "no";
}

std::vector<std::string> cells(const Row& row) {
  return {figureText(row),
          show(row.published),
          show(row.as_published),
          show(row.tautline),
          bandText(row),
          passText(row),
          row.note + (row.note.empty() || row.shortfall.empty() ? "" : "; ") + row.shortfall};
}

std::string countText(const std::vector<Chapter>& chapters) {
  const Tally t = tally(chapters);
  return fmt::format("{} of {} rows pass, {} fall short of a goal for a known reason, {} fail",
                     t.passed, t.rows(), t.short_of, t.failed);
}

std::string pageOf(const Setup& setup, const std::vector<Chapter>& chapters,
                   const std::vector<std::vector<report::EmbeddedPicture>>& pictures) {
  const Tally t = tally(chapters);
  std::string body = "<h1>Experiments</h1>\n";
  body += fmt::format("<p class=\"about\">seed {} · {}</p>\n<div class=\"banner {}\">{}</div>\n",
                      setup.seed, setup.quick ? "quick sample" : "all trials",
                      t.failed == 0 ? "good" : "bad", countText(chapters));
  for (std::size_t c = 0; c < chapters.size(); ++c) {
    const Experiment& e = *chapters[c].experiment;
    body += "<h2>" + escaped(e.title) + "</h2>\n<p>" + escaped(e.setup) + "</p>\n";
    report::HtmlTable table(kColumns);
    for (const Row& row : chapters[c].findings.rows)
      table.add(cells(row), row.pass() ? "" : row.fallsShort() ? "warning" : "error");
    body += table.html();
    for (const Sheet& sheet : chapters[c].findings.sheets) {
      if (sheet.caption.empty()) continue;
      report::HtmlTable numbers(sheet.columns);
      for (const std::vector<std::string>& row : sheet.rows) numbers.add(row);
      body += "<p>" + escaped(sheet.caption) + "</p>\n" + numbers.html();
    }
    for (const report::EmbeddedPicture& picture : pictures[c]) body += htmlFigure(picture);
  }
  return report::htmlPage("Experiments", body);
}

std::string markdownOf(const Setup& setup, const std::vector<Chapter>& chapters) {
  std::string text = fmt::format("# Experiments\n\nSeed {}, {}: {}.\n", setup.seed,
                                 setup.quick ? "quick sample" : "all trials", countText(chapters));
  for (const Chapter& chapter : chapters) {
    const Experiment& e = *chapter.experiment;
    text += fmt::format("\n## {}\n\n{}\n\n", e.title, e.setup);
    std::string rule;
    for (const std::string& column : kColumns) {
      const bool is_text = column.starts_with('<');
      text += "| " + column.substr(is_text ? 1 : 0) + " ";
      rule += is_text ? "|---" : "|---:";
    }
    text += "|\n" + rule + "|\n";
    for (const Row& row : chapter.findings.rows) {
      for (const std::string& cell : cells(row)) text += "| " + cell + " ";
      text += "|\n";
    }
  }
  return text;
}

std::string csvLine(const std::vector<std::string>& values) {
  std::string line;
  for (const std::string& value : values) {
    std::string quoted = value;
    if (value.find_first_of(",\"\n") != std::string::npos) {
      quoted = "\"";
      for (const char c : value) quoted += c == '"' ? "\"\"" : std::string(1, c);
      quoted += '"';
    }
    line += (line.empty() ? "" : ",") + quoted;
  }
  return line + "\n";
}

std::string rowsCsv(const std::vector<Chapter>& chapters) {
  std::string text =
      csvLine({"experiment", "figure", "unit", "published", "as_published", "tautline",
               "as_published_min", "as_published_max", "tautline_min", "tautline_max", "pass"});
  const auto number = [](const std::optional<double>& v) {
    return v && std::isfinite(*v) ? fmt::format("{}", *v) : std::string();
  };
  for (const Chapter& chapter : chapters) {
    for (const Row& r : chapter.findings.rows) {
      const Band none;
      const Band a = r.as_published_band.value_or(none);
      const Band t = r.tautline_band.value_or(none);
      text += csvLine({chapter.experiment->name, r.figure, r.unit, number(r.published),
                       number(r.as_published), number(r.tautline), number(a.min), number(a.max),
                       number(t.min), number(t.max), r.pass() ? "1" : "0"});
    }
  }
  return text;
}

}  // namespace

std::string reportJson(const std::vector<Chapter>& chapters) {
  json rows = json::array();
  for (const Chapter& chapter : chapters) {
    for (const Row& r : chapter.findings.rows) {
      rows.push_back(
          {{"experiment", chapter.experiment->name},
           {"figure", r.figure},
           {"unit", r.unit},
           {"published", jsonOf(r.published)},
           {"as_published", jsonOf(r.as_published)},
           {"tautline", jsonOf(r.tautline)},
           {"band",
            {{"as_published", jsonOf(r.as_published_band)}, {"tautline", jsonOf(r.tautline_band)}}},
           {"pass", r.pass()},
           {"note", r.note},
           {"shortfall", r.shortfall}});
    }
  }
  return rows.dump(1) + "\n";
}

std::string reportText(const std::vector<Chapter>& chapters) {
  std::string text;
  for (const Chapter& chapter : chapters) {
    text += fmt::format("{}\n", chapter.experiment->title);
    for (const Row& r : chapter.findings.rows) {
      text += fmt::format("  {} {:<52} published {:>7}  as published {:>7}  Tautline {:>7}  {}\n",
                          r.pass()              ? " "
                          : r.shortfall.empty() ? "✗"
                                                : "-",
                          figureText(r), show(r.published), show(r.as_published), show(r.tautline),
                          bandText(r));
    }
  }
  return text + countText(chapters) + "\n";
}

std::filesystem::path writeReport(const Setup& setup, const std::vector<Chapter>& chapters,
                                  const std::filesystem::path& folder) {
  report::OutputFolder out(folder);
  std::vector<std::vector<report::EmbeddedPicture>> pictures(chapters.size());
  for (std::size_t c = 0; c < chapters.size(); ++c) {
    const std::string experiment = chapters[c].experiment->name;
    for (const Sheet& sheet : chapters[c].findings.sheets) {
      std::string text = csvLine(sheet.columns);
      for (const auto& row : sheet.rows) text += csvLine(row);
      out.addText(experiment + "_" + sheet.name + ".csv", text);
    }
    for (const Picture& picture : chapters[c].findings.pictures) {
      const std::string name = experiment + "_" + picture.name;
      pictures[c].push_back({name, picture.caption, out.addFigure(name + ".svg", picture.figure)});
    }
  }
  out.addText("report.csv", rowsCsv(chapters));
  out.addText("report.json", reportJson(chapters));
  out.addText("report.md", markdownOf(setup, chapters));
  out.addText("report.html", pageOf(setup, chapters, pictures));
  return out.finish().back();
}

}  // namespace tautline::experiments
