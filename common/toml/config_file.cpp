#include "common/toml/config_file.h"

namespace tautline {

void ConfigWriter::line(const char* key, const std::string& value, const char* doc,
                        const std::string& allowed) {
  std::string comment = doc;
  if (!allowed.empty()) comment += (comment.empty() ? "" : "; ") + allowed;
  keys_ += std::string(key) + " = " + value + (comment.empty() ? "" : "  # " + comment) + "\n";
}

}  // namespace tautline
