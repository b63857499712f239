#include "planning_offline/risk/table_file.h"

#include <algorithm>

#include "common/error.h"
#include "common/toml/toml_file.h"
#include "planning_offline/risk/risk_params.h"

namespace tautline::planning {
namespace {

bool hasRisks(const TomlTable& table) { return table.has("elements") || table.has("finish"); }

TomlTable subTable(const TomlFile& file, const std::string& name) {
  return file.root().table(name).front();
}

std::vector<std::string> tablesWithRisks(const TomlFile& file) {
  std::vector<std::string> names;
  for (const std::string& name : file.root().tableNames()) {
    if (hasRisks(subTable(file, name))) names.push_back(name);
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

TomlTable chooseTable(const TomlFile& file, std::string_view name) {
  const bool at_top = hasRisks(file.root());
  if (name.empty() && at_top) return file.root();
  const std::vector<std::string> names = tablesWithRisks(file);
  if (name.empty() && names.size() == 1) return subTable(file, names.front());
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return subTable(file, std::string(name));
  }
  InputProblem problem{.file = file.name()};
  if (names.empty() && !at_top) {
    problem.problem = "has no table of risks";
    problem.remedy = "give elements = [[…], …] or finish = […]";
  } else if (name.empty()) {
    problem.problem = "has several tables of risks";
    problem.allowed = listed(names);
    problem.remedy = "name one of them";
  } else {
    problem.key = name;
    problem.line = file.lineOf(name);
    problem.problem = "is no table of risks in this file";
    problem.allowed = names.empty() ? "no name: they stand at the top of the file" : listed(names);
  }
  throw InputError(problem);
}

std::vector<std::vector<double>> readTable(const TomlFile& file, std::string_view name) {
  TomlTable table = chooseTable(file, name);
  std::vector<std::vector<double>> elements;
  std::vector<double> finish;
  const bool has_elements = table.read("elements", elements, kProbability);
  const bool has_finish = table.read("finish", finish, kProbability);
  if (has_elements && has_finish) {
    throw table.error("finish", "stands beside elements", "", "keep one of them");
  }
  for (const double p : finish) elements.push_back({1.0 - p});
  const char* key = has_elements ? "elements" : "finish";
  if (elements.empty()) throw table.error(key, "is empty", "at least one state");
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].empty()) {
      throw table.error("elements[" + std::to_string(i) + "]", "is empty", "at least one number");
    }
  }
  return elements;
}

}  // namespace

std::vector<std::vector<double>> readRiskTable(const std::filesystem::path& path,
                                               std::string_view table) {
  return readTable(TomlFile::load(path), table);
}

std::vector<std::vector<double>> parseRiskTable(std::string_view text, const std::string& name,
                                                std::string_view table) {
  return readTable(TomlFile::parse(text, name), table);
}

}  // namespace tautline::planning
