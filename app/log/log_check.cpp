#include "app/log/log_check.h"

#include <algorithm>
#include <set>
#include <string>

#include "app/log/message_decoder.h"

namespace tautline {

LogCheck checkLog(const std::filesystem::path& file,
                  const std::function<void(const LogEvent&)>& each) {
  EventLogReader reader(file);
  LogCheck result;
  result.bytes = reader.fileSize();
  std::set<std::string, std::less<>> channels_with_type;
  while (const auto event = reader.next()) {
    const MessageInfo* info = findMessage(event->data);
    const bool sound = info != nullptr ? decode(*info, event->data).has_value()
                                       : !channels_with_type.contains(event->channel);
    if (!sound) {
      result.damage.push_back({.offset = event->offset,
                               .bytes = event->data.size(),
                               .events_lost = 1,
                               .what = "data of an event, no message of its channel's type"});
      continue;
    }
    if (info != nullptr) channels_with_type.emplace(event->channel);
    ++result.events;
    each(*event);
  }
  result.damage.insert(result.damage.end(), reader.damage().begin(), reader.damage().end());
  std::stable_sort(result.damage.begin(), result.damage.end(),
                   [](const LogDamage& a, const LogDamage& b) { return a.offset < b.offset; });
  return result;
}

}  // namespace tautline
