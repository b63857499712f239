#include "planning_offline/tether/compare_contacts.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

/// Of the line from the reel over the contacts to the end.
double lengthOver(const Eigen::Vector3d& reel, const std::vector<Eigen::Vector3d>& contacts,
                  const Eigen::Vector3d& end) {
  double length = 0.0;
  Eigen::Vector3d anchor = reel;
  for (const Eigen::Vector3d& contact : contacts) {
    length += (contact - anchor).norm();
    anchor = contact;
  }
  return length + (end - anchor).norm();
}

}  // namespace

ContactComparison compareContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                  std::span<const Eigen::Vector3d> path,
                                  const PublishedOptions& options) {
  std::vector<PublishedState> published = publishedContacts(map, reel, path, options);
  const std::unique_ptr<TautString> string = makeTautString(map, reel);
  ContactComparison comparison;
  comparison.rows.reserve(path.size());
  StackId stack = kStraight;
  Eigen::Vector3d from = string->reel();
  for (std::size_t i = 0; i < path.size(); ++i) {
    stack = string->move(stack, from, path[i]);
    from = path[i];
    const double published_length = lengthOver(string->reel(), published[i].contacts, path[i]);
    comparison.rows.push_back({.waypoint = path[i],
                               .published = std::move(published[i]),
                               .published_length = published_length,
                               .exact = string->contacts(stack),
                               .exact_length = string->length(stack, path[i])});
  }
  comparison.unresolved_moves = string->unresolvedMoves();
  return comparison;
}

}  // namespace tautline::planning
