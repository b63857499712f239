#include "app/log/log_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <exception>
#include <string>

#include "app/log/event_log_writer.h"

namespace tautline {
namespace {

namespace fs = std::filesystem;

struct LogFile {
  fs::path path;
  std::int64_t written_ns{};  // Unix time of the last write
  std::uint64_t bytes{};      // on the disk
};

bool isLogName(const std::string& name) {
  const std::size_t at = name.rfind(".lcm");
  if (at == std::string::npos) return false;
  const std::string rest = name.substr(at + 4);
  return rest.empty() || (rest.size() > 1 && rest[0] == '.' &&
                          rest.find_first_not_of("0123456789", 1) == std::string::npos);
}

/// Oldest first.
std::vector<LogFile> logsIn(const fs::path& folder) {
  std::vector<LogFile> logs;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    struct stat status {};
    if (!isLogName(entry.path().filename()) || ::lstat(entry.path().c_str(), &status) != 0 ||
        !S_ISREG(status.st_mode))
      continue;
    constexpr std::uint64_t kBlock = 512;  // stat(2)
    logs.push_back({entry.path(),
                    std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec,
                    static_cast<std::uint64_t>(status.st_blocks) * kBlock});
  }
  std::sort(logs.begin(), logs.end(),
            [](const LogFile& a, const LogFile& b) { return a.written_ns < b.written_ns; });
  return logs;
}

}  // namespace

std::vector<fs::path> keepQuota(const fs::path& folder, std::uint64_t quota) noexcept {
  std::vector<fs::path> deleted;
  try {
    const std::vector<LogFile> logs = logsIn(folder);
    std::uint64_t used = 0;
    for (const LogFile& log : logs) used += log.bytes;
    for (const LogFile& log : logs) {
      if (used <= quota) break;
      std::error_code error;
      if (isBeingWritten(log.path) || !fs::remove(log.path, error)) continue;
      used -= log.bytes;
      deleted.push_back(log.path);
    }
  } catch (const std::exception&) {
    // A folder that goes away meanwhile needs no quota.
  }
  return deleted;
}

}  // namespace tautline
