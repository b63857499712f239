#include "app/report/html.h"

#include "common/markup.h"

namespace tautline::report {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #222; background: #fff; margin: 0 auto; max-width: 960px; padding: 0 16px 48px; }
h1 { font-size: 1.5em; margin: 20px 0 4px; }
h2 { font-size: 1.15em; margin: 32px 0 8px; }
p.about { color: #666; margin: 0 0 12px; overflow-wrap: anywhere; }
.banner { border-left: 6px solid; border-radius: 4px; padding: 12px 16px; font-size: 1.1em; font-weight: 600; }
.good { background: #e6f4ee; border-color: #009e73; }
.bad { background: #fbeae0; border-color: #d55e00; }
.none { background: #f0f0f0; border-color: #808080; }
.key { display: grid; grid-template-columns: repeat(auto-fill, minmax(140px, 1fr)); gap: 10px; margin: 16px 0; }
.key div { background: #f6f7f8; border-radius: 4px; padding: 8px 12px; }
.key b { display: block; font-size: 1.35em; font-variant-numeric: tabular-nums; }
.key span { color: #666; font-size: 0.87em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }
th { color: #666; font-weight: 500; border-bottom-color: #bbb; }
td.text, th.text { text-align: left; white-space: normal; }
figure { margin: 16px 0; }
figure svg { width: 100%; height: auto; }
figcaption { color: #666; font-size: 0.9em; }
.error td, .critical td { background: #fbeae0; }
.warning td { background: #fdf5e0; }
)";

/// The picture without what belongs to a file of its own; its ids made unique in the page.
std::string inlineSvg(const EmbeddedPicture& picture) {
  const std::size_t begin = picture.svg.find("<svg");
  std::string svg = begin == std::string::npos ? std::string() : picture.svg.substr(begin);
  for (const char* id : {"'gp", "#gp", "\"gnuplot_", "'gnuplot_", "#gnuplot_", "\"textbox",
                         "'textbox", "#textbox", "\"greybox", "'greybox", "#greybox"}) {
    for (std::size_t at = svg.find(id); at != std::string::npos;
         at = svg.find(id, at + picture.name.size() + 2)) {
      svg.insert(at + 1, picture.name + "_");
    }
  }
  return svg;
}

}  // namespace

HtmlTable::HtmlTable(const std::vector<std::string>& columns) {
  for (const auto& column : columns) {
    is_text_.push_back(column.starts_with('<'));
    html_ += is_text_.back() ? "<th class=\"text\">" + escaped(column.substr(1))
                             : "<th>" + escaped(column);
    html_ += "</th>";
  }
  html_ = "<div class=\"scroll\"><table>\n<tr>" + html_ + "</tr>\n";
}

void HtmlTable::add(const std::vector<std::string>& cells, const std::string& row_class) {
  html_ += row_class.empty() ? "<tr>" : "<tr class=\"" + row_class + "\">";
  for (std::size_t i = 0; i < cells.size(); ++i)
    html_ += (is_text_[i] ? "<td class=\"text\">" : "<td>") + escaped(cells[i]) + "</td>";
  html_ += "</tr>\n";
}

std::string htmlFigure(const EmbeddedPicture& picture) {
  return "<figure>\n" + inlineSvg(picture) + "<figcaption>" + escaped(picture.caption) +
         "</figcaption>\n</figure>\n";
}

std::string htmlPage(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + body +
         "</body>\n</html>\n";
}

}  // namespace tautline::report
