#include "app/station/emulated_machine.h"

#include <algorithm>
#include <fstream>
#include <string>

namespace tautline {

bool hasEmulatedUart(std::string_view kernel_command_line) noexcept {
  constexpr std::string_view kSpace = " \t\n";
  for (std::string_view rest = kernel_command_line; !rest.empty();) {
    const std::size_t begin = rest.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return false;
    rest.remove_prefix(begin);
    const std::size_t end = std::min(rest.find_first_of(kSpace), rest.size());
    if (rest.substr(0, end) == kEmulatedUartWord) return true;
    rest.remove_prefix(end);
  }
  return false;
}

bool thisMachineHasEmulatedUart() {
  std::ifstream file("/proc/cmdline");
  std::string line;
  return std::getline(file, line) && hasEmulatedUart(line);
}

}  // namespace tautline
