/// @file
/// `tautline help conditions`: every condition and every transition, from the tables that the
/// station itself runs on. docs/operator_guide.md is made of it.

#include <memory>
#include <vector>

#include <fmt/format.h>

#include "app/cli/flight/verbs.h"

namespace tautline::cli::flight {
namespace {

using Row = std::vector<std::string>;

struct Table {
  const char* title;
  Row head;
  std::vector<Row> rows;
};

std::string secondsText(double s) { return s == 0.0 ? "at once" : fmt::format("{:g} s", s); }

Row rowOf(const ConditionInfo& c) {
  return {c.name, c.text, c.unit, secondsText(c.guard_s), secondsText(c.recovery_s), c.remedy};
}

Table conditionTable(const char* title, ConditionKind kind) {
  Table table{title, {"flag", "meaning", "unit", "counts after", "gone after", "remedy"}, {}};
  for (const ConditionInfo& c : kConditionInfos)
    if (c.kind == kind) table.rows.push_back(rowOf(c));
  return table;
}

std::string modesText(ModeMask mask) {
  std::string text;
  ModeMask all = 0;
  for (const auto& mode : kModeNames) all = static_cast<ModeMask>(all | maskOf({mode.value}));
  if ((mask & all) == all) return "every mode";
  for (const auto& mode : kModeNames)
    if (isIn(mode.value, mask)) text += (text.empty() ? "" : " ") + std::string(mode.name);
  return text;
}

/// What happens by itself, or on request; first that fits wins.
Table transitionTableOf(const char* title, bool on_request) {
  Table table{title, {"from", on_request ? "request" : "any of", "all of", "unless", "to"}, {}};
  int count = 0;
  const Transition* rows = transitionTable(count);
  for (int i = 0; i < count; ++i) {
    const Transition& t = rows[i];
    if ((t.request != Request::kNone) != on_request) continue;
    table.rows.push_back(
        {modesText(t.from),
         on_request ? std::string(nameOf(t.request, kRequestNames)) : describe(t.when_any),
         describe(t.when_all), describe(t.unless), nameOf(t.to, kModeNames)});
  }
  return table;
}

std::string markdown(const Table& table) {
  const auto line = [](const Row& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) text += " " + cell + " |";
    return text + "\n";
  };
  std::string text = fmt::format("### {}\n\n", table.title) + line(table.head) + "|";
  for (std::size_t i = 0; i < table.head.size(); ++i) text += "---|";
  text += "\n";
  for (const Row& row : table.rows) text += line(row);
  return text;
}

std::string words(const Table& table) {
  std::string text = std::string(table.title) + "\n";
  for (const Row& row : table.rows) {
    text += "  " + row[0] + "\n";
    for (std::size_t i = 1; i < row.size(); ++i)
      if (!row[i].empty()) text += fmt::format("      {:<13} {}\n", table.head[i], row[i]);
  }
  return text;
}

std::vector<Table> tables() {
  return {conditionTable("Arming checks, also acted on in flight", ConditionKind::kForbidsArming),
          conditionTable("Acted on in flight", ConditionKind::kInFlight),
          conditionTable("Warnings", ConditionKind::kWarns),
          conditionTable("Facts", ConditionKind::kFact),
          transitionTableOf("What the station does by itself, most severe first", false),
          transitionTableOf("What it does on request", true)};
}

}  // namespace

void addHelpVerb(CLI::App& root, ExitCode& result) {
  CLI::App* help =
      root.add_subcommand("help", "Longer texts; `tautline VERB --help` explains a verb");
  help->require_subcommand(1);
  const auto as_markdown = std::make_shared<bool>(false);
  CLI::App* conditions = help->add_subcommand(
      "conditions",
      "Every arming check and failsafe with its remedy, and what leads to which mode");
  conditions->add_flag("--markdown", *as_markdown, "as tables for a document");
  conditions->footer("Example: tautline help conditions | less");
  conditions->callback([as_markdown, &result] {
    std::string text;
    for (const Table& table : tables())
      text += (text.empty() ? "" : "\n") + (*as_markdown ? markdown(table) : words(table));
    fmt::print("{}", text);
    result = ExitCode::kOk;
  });
}

}  // namespace tautline::cli::flight
