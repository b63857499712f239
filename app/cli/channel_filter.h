#pragma once

/// @file
/// Choice of channels by a regular expression, as users type it.

#include <optional>
#include <regex>
#include <string>
#include <string_view>

#include "common/error.h"

namespace tautline::cli {

class ChannelFilter {
 public:
  /// Found anywhere in a channel's name; empty: every channel. @throws InputError (exit code
  /// kUsage) for what is no regular expression; `option` is named in it.
  explicit ChannelFilter(const std::string& expression = {}, const char* option = "filter") {
    if (expression.empty()) return;
    try {
      expression_.emplace(expression, std::regex::ECMAScript | std::regex::icase);
    } catch (const std::regex_error&) {
      throw InputError({.key = option,
                        .problem = '\'' + expression + "' is no regular expression",
                        .allowed = "e.g. 'STATE$' or 'ESTIMATE|COMMAND'"},
                       ExitCode::kUsage);
    }
  }

  [[nodiscard]] bool matches(std::string_view channel) const {
    return !expression_ || std::regex_search(channel.begin(), channel.end(), *expression_);
  }

 private:
  std::optional<std::regex> expression_;
};

}  // namespace tautline::cli
