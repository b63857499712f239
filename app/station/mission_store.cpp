#include "app/station/mission_store.h"

#include <cmath>
#include <cstddef>

namespace tautline {
namespace {

Eigen::Vector3d toVector(const double (&p)[3]) noexcept { return {p[0], p[1], p[2]}; }

bool isPosition(const double (&p)[3]) noexcept {
  constexpr double kFarthest = 1e4;  // [m], beyond any tether
  for (const double x : p) {
    if (!(std::abs(x) <= kFarthest)) return false;  // written so that NaN fails
  }
  return true;
}

bool hasValidShape(const mission_chunk_t& c) noexcept {
  const int total = c.kind == 0 ? c.waypoint_total : c.contact_total;
  return (c.kind == 0 || c.kind == 1) && c.waypoint_total >= 1 &&
         c.waypoint_total <= kMaxWaypoints && c.contact_total >= 0 &&
         c.contact_total <= kMaxContacts && c.count >= 1 && c.count <= mission_chunk_t::CAPACITY &&
         c.first >= 0 && c.first <= total - c.count;
}

bool isValidItem(const mission_chunk_t& c, int i) noexcept {
  if (!isPosition(c.position_m[i])) return false;
  if (c.kind == 1) return c.contact_id[i] > 0;
  return c.contact_id[i] >= 0 && (!c.has_look_at[i] || isPosition(c.look_at_m[i])) &&
         c.speed_mps[i] >= 0.0 && c.speed_mps[i] <= 10.0 && c.hold_s[i] >= 0.0 &&
         c.hold_s[i] <= 1e5 && c.risk[i] >= 0.0 && c.risk[i] <= 1.0;
}

}  // namespace

void MissionStore::begin(const mission_chunk_t& chunk) noexcept {
  MissionPlan& plan = plans_[incoming_];
  plan.hash = static_cast<std::uint64_t>(chunk.mission_hash);
  plan.waypoint_count = chunk.waypoint_total;
  plan.contact_count = chunk.contact_total;
  has_waypoint_.reset();
  has_contact_.reset();
  complete_ = false;
}

bool MissionStore::add(const mission_chunk_t& c) noexcept {
  if (c.mission_hash == 0 || !hasValidShape(c)) return false;
  for (int i = 0; i < c.count; ++i) {
    if (!isValidItem(c, i)) return false;
  }
  MissionPlan& plan = plans_[incoming_];
  const bool same = plan.hash == static_cast<std::uint64_t>(c.mission_hash) &&
                    plan.waypoint_count == c.waypoint_total &&
                    plan.contact_count == c.contact_total;
  if (!same) begin(c);
  if (complete_) return true;

  for (int i = 0; i < c.count; ++i) {
    const auto index = static_cast<std::size_t>(c.first + i);
    if (c.kind == 1) {
      plan.contacts[index] = {c.contact_id[i], toVector(c.position_m[i])};
      has_contact_.set(index);
      continue;
    }
    Waypoint& w = plan.waypoints[index];
    w = Waypoint{};
    w.p_WD = toVector(c.position_m[i]);
    w.contact = c.contact_id[i];
    if (c.has_look_at[i]) w.p_WL = toVector(c.look_at_m[i]);
    w.speed = c.speed_mps[i];
    w.hold = c.hold_s[i];
    w.risk = c.risk[i];
    has_waypoint_.set(index);
  }
  complete_ = isComplete();
  return true;
}

bool MissionStore::isComplete() const noexcept {
  const MissionPlan& plan = incoming();
  if (has_waypoint_.count() != static_cast<std::size_t>(plan.waypoint_count)) return false;
  if (has_contact_.count() != static_cast<std::size_t>(plan.contact_count)) return false;
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const int id = plan.waypoints[static_cast<std::size_t>(i)].contact;
    if (id != kReelContact && plan.findContact(id) == nullptr) return false;
  }
  return true;
}

void MissionStore::activate() noexcept {
  incoming_ = 1 - incoming_;
  has_active_ = true;
  has_waypoint_.reset();
  has_contact_.reset();
  complete_ = false;
  plans_[incoming_].hash = 0;
}

}  // namespace tautline
