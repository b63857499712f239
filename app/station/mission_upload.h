#pragma once

/// @file
/// A mission cut into MISSION_CHUNK messages: the other side of MissionStore, for every client that
/// sends missions.

#include <functional>

#include <tautline/mission_chunk_t.hpp>

#include "common/mission_plan.h"

namespace tautline {

/// Calls `send` for each chunk, contacts first, until it returns false; returns whether all were
/// sent. Session, sequence and utime are left to `send`. Not real-time safe: clients only.
bool forEachChunk(const MissionPlan& plan,
                  const std::function<bool(tautline::mission_chunk_t&)>& send);

}  // namespace tautline
