#include "app/report/output_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/error.h"

namespace tautline::report {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& problem) {
  throw InputError({file.string(), 0, {}, problem, {}, "give another folder with --out"},
                   ExitCode::kFailed);
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target)
    : target_(target.has_filename() ? target : target.parent_path())  // "out/" is "out"
{
  const fs::path parent = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  std::error_code error;
  fs::create_directories(parent, error);
  std::string name = (parent / (target_.filename().string() + ".XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr)
    fail(target_, std::string("cannot write here: ") + std::strerror(errno));
  temporary_ = name;
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void OutputFolder::addText(const std::string& name, const std::string& text) {
  std::ofstream out(temporary_ / name, std::ios::binary);
  out << text;
  out.close();
  if (!out) fail(target_ / name, std::string("cannot write: ") + std::strerror(errno));
  names_.push_back(name);
}

std::string OutputFolder::addFigure(const std::string& name, const plot::Figure& figure) {
  plot::writeSvg(figure, temporary_ / name);
  names_.push_back(name);
  std::ostringstream text;
  text << std::ifstream(temporary_ / name, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<fs::path> OutputFolder::finish() {
  std::vector<fs::path> files;
  std::error_code error;
  fs::create_directories(target_, error);
  for (const auto& name : names_) {
    if (!error) fs::rename(temporary_ / name, target_ / name, error);
    files.push_back(target_ / name);
  }
  if (error) fail(target_, "cannot write here: " + error.message());
  return files;
}

}  // namespace tautline::report
