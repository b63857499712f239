#include "common/error.h"

#include <cstdio>
#include <cstdlib>

namespace tautline {

std::string describe(const InputProblem& p) {
  std::string text = p.file;
  if (p.line > 0) text += ":" + std::to_string(p.line);
  for (const std::string* part : {&p.key, &p.problem}) {
    if (part->empty()) continue;
    if (!text.empty()) text += ": ";
    text += *part;
  }
  if (!p.allowed.empty()) text += "; allowed: " + p.allowed;
  if (!p.remedy.empty()) text += "; " + p.remedy;
  return text;
}

void checkFailed(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "tautline: internal check failed: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace tautline
