#pragma once

/// @file
/// A folder of logs that stays within a quota. Not real-time safe.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tautline {

/// Deletes the oldest logs (*.lcm, and the *.lcm.NN of lcm-logger) of `folder` until all together
/// take no more than `quota` bytes of the disk; returns what it deleted. One that an EventLogWriter
/// is at is never deleted, nor is any other file. By time of the last write: the clock that is in
/// the names was as wrong as that.
std::vector<std::filesystem::path> keepQuota(const std::filesystem::path& folder,
                                             std::uint64_t quota) noexcept;

}  // namespace tautline
