#include "app/report/report_writer.h"

#include <algorithm>

#include "app/report/output_folder.h"
#include "app/report/report_figures.h"
#include "app/report/report_text.h"

namespace tautline::report {

std::vector<std::filesystem::path> writeReport(const FlightLog& log, const FlightAnalysis& flight,
                                               const Scene* scene,
                                               const std::filesystem::path& folder) {
  OutputFolder out(folder);
  std::vector<EmbeddedPicture> pictures;
  out.addText("report.json", reportJson(log, flight));
  out.addText("series.csv", seriesCsv(log, flight));
  for (const NamedFigure& named : reportFigures(log, flight, scene)) {
    std::string svg = out.addFigure(named.name + ".svg", named.figure);
    if (named.on_page) pictures.push_back({named.name, named.caption, std::move(svg)});
  }
  out.addText("report.html", reportHtml(log, flight, pictures));
  std::vector<std::filesystem::path> files = out.finish();
  std::rotate(files.begin(), files.end() - 1, files.end());  // the page first
  return files;
}

}  // namespace tautline::report
