#pragma once

/// @file
/// Pieces of our HTML pages: the page with its style, tables, pictures. A page is one file that
/// needs nothing else. Pure functions.

#include <string>
#include <vector>

namespace tautline::report {

/// A table row by row; columns whose name starts with '<' hold text.
class HtmlTable {
 public:
  explicit HtmlTable(const std::vector<std::string>& columns);
  /// `row_class`: error, critical, warning, or none.
  void add(const std::vector<std::string>& cells, const std::string& row_class = {});
  [[nodiscard]] std::string html() const { return html_ + "</table></div>\n"; }

 private:
  std::vector<bool> is_text_;
  std::string html_;
};

/// A picture that goes into the page.
struct EmbeddedPicture {
  std::string name;  ///< Unique in the page.
  std::string caption;
  std::string svg;
};

[[nodiscard]] std::string htmlFigure(const EmbeddedPicture& picture);

/// The whole file. `body` is HTML, `title` is text.
[[nodiscard]] std::string htmlPage(const std::string& title, const std::string& body);

}  // namespace tautline::report
