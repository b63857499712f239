#include "app/report/report_writer.h"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "app/report/report_figures.h"
#include "app/report/report_text.h"
#include "common/error.h"

namespace tautline::report {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& problem) {
  throw InputError({file.string(), 0, {}, problem, {}, "give another folder with --out"},
                   ExitCode::kFailed);
}

// A new folder beside `target`, removed with all in it at the end.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& target) {
    const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code error;
    fs::create_directories(parent, error);
    std::string name = (parent / (target.filename().string() + ".XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr)
      fail(target, std::string("cannot write here: ") + std::strerror(errno));
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void writeText(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) fail(file, std::string("cannot write: ") + std::strerror(errno));
}

std::string readText(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

std::vector<fs::path> writeReport(const FlightLog& log, const FlightAnalysis& flight,
                                  const Scene* scene, const fs::path& folder) {
  const fs::path target = folder.has_filename() ? folder : folder.parent_path();  // "out/" is "out"
  const TemporaryFolder temporary(target);
  std::vector<std::string> names{"report.html", "report.json", "series.csv"};
  std::vector<EmbeddedPicture> pictures;
  for (const auto& named : reportFigures(log, flight, scene)) {
    const std::string name = named.name + ".svg";
    plot::writeSvg(named.figure, temporary.path() / name);
    if (named.on_page)
      pictures.push_back({named.name, named.caption, readText(temporary.path() / name)});
    names.push_back(name);
  }
  writeText(temporary.path() / "report.html", reportHtml(log, flight, pictures));
  writeText(temporary.path() / "report.json", reportJson(log, flight));
  writeText(temporary.path() / "series.csv", seriesCsv(log, flight));

  std::vector<fs::path> files;
  std::error_code error;
  fs::create_directories(target, error);
  for (const auto& name : names) {
    if (!error) fs::rename(temporary.path() / name, target / name, error);
    files.push_back(target / name);
  }
  if (error) fail(target, "cannot write here: " + error.message());
  return files;
}

}  // namespace tautline::report
