#include "common/toml/config_file.h"

namespace tautline {

InputError ConfigReader::tooMany(const char* key, std::size_t count, std::size_t room) const {
  return table_.error(key, "has " + std::to_string(count) + " entries",
                      "at most " + std::to_string(room));
}

void ConfigWriter::line(const char* key, const std::string& value, const char* doc,
                        const std::string& allowed) {
  std::string comment = doc;
  if (!allowed.empty()) comment += (comment.empty() ? "" : "; ") + allowed;
  keys_ += std::string(key) + " = " + value + (comment.empty() ? "" : "  # " + comment) + "\n";
}

}  // namespace tautline
