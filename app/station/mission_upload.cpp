#include "app/station/mission_upload.h"

#include <algorithm>
#include <utility>

namespace tautline {
namespace {

void put(double (&out)[3], const Eigen::Vector3d& p) {
  for (int i = 0; i < 3; ++i) out[i] = p[i];
}

/// Chunk of `count` items from `first` on; all unused fields zero.
tautline::mission_chunk_t makeChunk(const MissionPlan& plan, int kind, int first, int count) {
  tautline::mission_chunk_t chunk{};
  chunk.mission_hash = static_cast<std::int64_t>(plan.hash);
  chunk.waypoint_total = plan.waypoint_count;
  chunk.contact_total = plan.contact_count;
  chunk.kind = static_cast<std::int8_t>(kind);
  chunk.first = first;
  chunk.count = count;
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::size_t>(first + i);
    if (kind == 1) {
      chunk.contact_id[i] = plan.contacts[index].id;
      put(chunk.position_m[i], plan.contacts[index].p_WC);
      continue;
    }
    const Waypoint& w = plan.waypoints[index];
    put(chunk.position_m[i], w.p_WD);
    chunk.contact_id[i] = w.contact;
    chunk.has_look_at[i] = w.p_WL.has_value() ? 1 : 0;
    if (w.p_WL) put(chunk.look_at_m[i], *w.p_WL);
    chunk.speed_mps[i] = w.speed;
    chunk.hold_s[i] = w.hold;
    chunk.risk[i] = w.risk;
  }
  return chunk;
}

}  // namespace

bool forEachChunk(const MissionPlan& plan,
                  const std::function<bool(tautline::mission_chunk_t&)>& send) {
  for (const auto& [kind, total] :
       {std::pair{1, plan.contact_count}, std::pair{0, plan.waypoint_count}}) {
    for (int first = 0; first < total; first += tautline::mission_chunk_t::CAPACITY) {
      const int count = std::min<int>(tautline::mission_chunk_t::CAPACITY, total - first);
      tautline::mission_chunk_t chunk = makeChunk(plan, kind, first, count);
      if (!send(chunk)) return false;
    }
  }
  return true;
}

}  // namespace tautline
