#pragma once

/// @file
/// Who else has a device open: for the error message when it is busy.

#include <string>

namespace tautline {

/// "minicom (pid 1234)", or "another program" where /proc does not say (other users' programs).
/// Not real-time safe: start-up only.
[[nodiscard]] std::string describeHolder(const std::string& device);

}  // namespace tautline
