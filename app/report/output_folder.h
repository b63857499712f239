#pragma once

/// @file
/// Files that appear in a folder all together or not at all. Not real-time safe.

#include <filesystem>
#include <string>
#include <vector>

#include "common/plot/figure.h"

namespace tautline::report {

/// Files are made in a temporary folder beside `target` and moved into place by finish(): after an
/// error (InputError: no gnuplot, disk full, no permission) `target` is as it was. Other files in
/// it stay.
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& target);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  void addText(const std::string& name, const std::string& text);
  /// Draws the figure and returns its SVG.
  std::string addFigure(const std::string& name, const plot::Figure& figure);

  /// Moves all files into place. Returns their paths in the order in which they were added.
  std::vector<std::filesystem::path> finish();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::vector<std::string> names_;
};

}  // namespace tautline::report
