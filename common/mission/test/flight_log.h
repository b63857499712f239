#pragma once

/// @file
/// Logs of real flights for tests that use them where they are.

#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>

namespace tautline {

/// One file of the archive of flight logs; empty if it cannot be unpacked.
inline std::string flightLog(const std::filesystem::path& archive, const std::string& name) {
  const std::string command = "tar -xJOf '" + archive.string() + "' './" + name + "' 2>/dev/null";
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    std::array<char, 4096> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
      text.append(buffer.data(), count);
    pclose(pipe);
  }
  return text;
}

}  // namespace tautline
