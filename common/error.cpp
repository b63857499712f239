#include "common/error.h"

#include <cstdio>
#include <cstdlib>
#include <exception>

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

int reportException(const char* program) noexcept {
  try {
    throw;
  } catch (const InputError& e) {
    std::fprintf(stderr, "%s: error: %s\n", program, e.what());
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: error: %s\n", program, e.what());
  } catch (...) {
    std::fprintf(stderr, "%s: error: unknown exception\n", program);
  }
  return static_cast<int>(ExitCode::kFailed);
}

void checkFailed(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "tautline: internal check failed: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace tautline
