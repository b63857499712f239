#pragma once

/// @file
/// Joining LCM, with one clear line where the machine does not allow it.

#include <string>

#include "common/error.h"
#include "common/multicast.h"
#include "lcmtypes/channels.h"

namespace tautline {

/// The error of a program that cannot go on without LCM: no route, or a URL that LCM does not know.
[[nodiscard]] inline InputError cannotJoin(const std::string& url) {
  if (!hasMulticastRoute(url)) {
    return InputError(
        {.key = "LCM " + url, .problem = "cannot be joined", .remedy = kMulticastRemedy},
        ExitCode::kTimeout);
  }
  return InputError({.key = "--lcm-url",
                     .problem = url + " cannot be joined",
                     .allowed = std::string("e.g. ") + kDefaultLcmUrl},
                    ExitCode::kUsage);
}

/// `url` itself. @throws InputError where there is no multicast route for it.
inline const std::string& reachable(const std::string& url) {
  if (!hasMulticastRoute(url)) throw cannotJoin(url);
  return url;
}

}  // namespace tautline
