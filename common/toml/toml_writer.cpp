#include "common/toml/toml_writer.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <limits>
#include <system_error>

#include "common/error.h"

namespace tautline {
namespace {

/// Shortest text that reads back to the same bits; no decimal point added.
std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

bool isBare(double bound) {
  return bound == std::numeric_limits<double>::max() ||
         bound == std::numeric_limits<double>::lowest();
}

}  // namespace

std::string tomlText(double value) {
  std::string text = shortest(value);
  // "5" would be an integer in TOML, and "1e+22" is a float already; so are "inf" and "nan", which
  // no reader here accepts.
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

std::string tomlText(int value) { return std::to_string(value); }

std::string tomlText(bool value) { return value ? "true" : "false"; }

std::string tomlText(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04X", static_cast<unsigned>(c));
      text += escape.data();
    } else {
      text += c;
    }
  }
  return text + '"';
}

std::string tomlText(const Eigen::Vector3d& value) {
  return "[" + tomlText(value.x()) + ", " + tomlText(value.y()) + ", " + tomlText(value.z()) + "]";
}

std::string tomlText(std::span<const Eigen::Vector2d> points) {
  std::string text;
  for (const Eigen::Vector2d& p : points)
    text += (text.empty() ? "" : ", ") + std::string("[") + tomlText(p.x()) + ", " +
            tomlText(p.y()) + "]";
  return "[" + text + "]";
}

std::string rangeText(Range range) {
  if (isBare(range.min) && isBare(range.max)) return "any finite number";
  if (isBare(range.max)) return "at least " + shortest(range.min);
  if (isBare(range.min)) return "at most " + shortest(range.max);
  return shortest(range.min) + " to " + shortest(range.max);
}

void writeFileAtomically(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path temporary = path.string() + ".tmp";
  std::FILE* file = std::fopen(temporary.c_str(), "wbe");
  bool ok = file != nullptr;
  int error = errno;
  if (ok) {
    ok = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    ok = std::fflush(file) == 0 && fsync(fileno(file)) == 0 && ok;
    error = errno;
    ok = std::fclose(file) == 0 && ok;
  }
  std::error_code rename_error;
  if (ok) {
    std::filesystem::rename(temporary, path, rename_error);
    error = rename_error.value();
  }
  if (ok && !rename_error) return;
  std::error_code ignored;
  if (file != nullptr) std::filesystem::remove(temporary, ignored);
  throw InputError({.file = path.string(),
                    .problem = std::string("cannot be written: ") + std::strerror(error),
                    .remedy = "check that the folder exists and is writable"});
}

}  // namespace tautline
