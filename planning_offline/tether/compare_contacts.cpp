#include "planning_offline/tether/compare_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tautline::planning {

ContactComparison compareContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                  std::span<const Eigen::Vector3d> path,
                                  const PublishedOptions& options) {
  ContactPlan published = planContacts(
      map, reel, path, {.algorithm = ContactAlgorithm::kAsPublished, .published = options});
  ContactPlan exact = planContacts(map, reel, path, {.algorithm = ContactAlgorithm::kExact});
  ContactComparison comparison{.unresolved_moves = exact.unresolved_moves};
  for (std::size_t i = 0; i < path.size(); ++i)
    comparison.rows.push_back({std::move(published.states[i]), std::move(exact.states[i])});
  return comparison;
}

std::ptrdiff_t countRefused(const ContactComparison& comparison) {
  return std::count_if(comparison.rows.begin(), comparison.rows.end(),
                       [](const ContactRow& row) { return row.published.relaxation_refused; });
}

std::ptrdiff_t countPierced(const ContactComparison& comparison) {
  return std::count_if(comparison.rows.begin(), comparison.rows.end(),
                       [](const ContactRow& row) { return row.published.pierces; });
}

double largestDifference(const ContactComparison& comparison) {
  double largest = 0.0;
  for (const ContactRow& row : comparison.rows)
    largest = std::max(largest, std::abs(row.published.length - row.exact.length));
  return largest;
}

}  // namespace tautline::planning
