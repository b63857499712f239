#pragma once

/// @file
/// Joining LCM, with one clear line where the machine does not allow it.

#include <string>

#include "common/error.h"
#include "common/multicast.h"
#include "lcmtypes/channels.h"

namespace tautline {

/// The error of a program that cannot go on without LCM.
[[nodiscard]] inline InputError cannotJoin(const std::string& url) {
  return InputError(
      {.key = "LCM " + url, .problem = "cannot be joined", .remedy = kMulticastRemedy},
      ExitCode::kTimeout);
}

/// `url` itself. @throws InputError where there is no multicast route for it.
inline const std::string& reachable(const std::string& url) {
  if (!hasMulticastRoute(url)) throw cannotJoin(url);
  return url;
}

}  // namespace tautline
