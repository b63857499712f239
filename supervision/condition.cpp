#include "supervision/condition.h"

namespace tautline {

std::string describe(ConditionSet set) {
  std::string text;
  for (const ConditionInfo& info : kConditionInfos) {
    if (!set.has(info.condition)) continue;
    if (!text.empty()) text += ' ';
    text += info.name;
  }
  return text;
}

}  // namespace tautline
