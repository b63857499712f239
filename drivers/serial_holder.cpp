#include "drivers/serial_holder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace tautline {
namespace {

namespace fs = std::filesystem;

bool isProcess(const fs::path& path) {
  const std::string name = path.filename().string();
  return std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool holds(const fs::path& process, const struct stat& device) {
  std::error_code error;
  for (fs::directory_iterator fd(process / "fd", error), end; !error && fd != end;
       fd.increment(error)) {
    struct stat open_file {};
    if (::stat(fd->path().c_str(), &open_file) == 0 && S_ISCHR(open_file.st_mode) &&
        open_file.st_rdev == device.st_rdev && open_file.st_dev == device.st_dev) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string describeHolder(const std::string& device) {
  struct stat target {};
  if (::stat(device.c_str(), &target) == 0) {
    std::error_code error;
    for (fs::directory_iterator process("/proc", error), end; !error && process != end;
         process.increment(error)) {
      if (!isProcess(process->path()) || !holds(process->path(), target)) continue;
      std::string program;
      std::getline(std::ifstream(process->path() / "comm"), program);
      return program + " (pid " + process->path().filename().string() + ")";
    }
  }
  return "another program";
}

}  // namespace tautline
