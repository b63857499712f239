#include "planning_offline/search/fast/test/random_costs.h"

#include <cmath>
#include <limits>
#include <utility>

namespace tautline::planning::testing {
namespace {

constexpr double kAccessPerUnit = 0.05;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double costOf(double risk) { return -std::log1p(-risk); }

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_()) / 4294967296.0;
  }

 private:
  std::mt19937 engine_;
};

double turnCost(Turns turns, Direction p, Direction d, double risk, Random& random) {
  const Eigen::Vector3d a = stepOf(p).cast<double>();
  const Eigen::Vector3d b = stepOf(d).cast<double>();
  const double change = (b - a).norm();
  switch (turns) {
    case Turns::kConstant:
      return p == d ? 0.0 : costOf(risk);
    case Turns::kLinear:
      return costOf(risk * change);
    case Turns::kQuadratic:
      return costOf(risk * change * change / 4.0);
    case Turns::kThreshold:
      return costOf(std::min(0.9, risk * change * (a.dot(b) > 0.7 * a.norm() * b.norm() ? 1 : 12)));
    case Turns::kAny:
      break;
  }
  return random.uniform(0.0, 0.3);  // straight on included
}

}  // namespace

std::string CostKind::text() const {
  return std::string(nameOf(connectivity, kConnectivityNames)) + (planar ? " planar" : "") +
         " turns " + std::to_string(static_cast<int>(turns)) + (rate ? " rate" : "") +
         (access ? " access" : "") + (free_ways ? " free ways" : "") +
         (forbidden ? " forbidden" : "");
}

UnitCosts::Access RandomCosts::access() const {
  if (field.character.empty()) return {};
  return [this](CellIndex from, CellIndex to) {
    const double lost = static_cast<double>(field.character[at(from)]) -
                        static_cast<double>(field.character[at(to)]);
    return lost > 0.0 ? costOf(kAccessPerUnit * lost) : 0.0;
  };
}

double RandomCosts::stepCost(CellIndex u, Direction incoming, Direction d) const {
  const CellIndex v = lattice.neighbour(u, d);
  const UnitCosts::Access extra = access();
  return field.locale_out[at(d)] * field.locale[at(u)] +
         field.locale_in[at(d)] * field.locale[at(v)] + field.action[at(d)] +
         field.turn[at(incoming)][at(d)] + (extra ? extra(u, v) : 0.0);
}

RandomCosts randomCosts(const GridShape& shape, double blocked, const CostKind& kind,
                        std::uint32_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> free;
  for (std::size_t i = 0; i < shape.size(); ++i)
    free.push_back(random.uniform(0.0, 1.0) < blocked ? 0 : 1);
  const auto start =
      static_cast<CellIndex>(random.uniform(0.0, static_cast<double>(shape.size()) - 0.5));
  free[at(start)] = 1;

  CostField field;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const bool nothing = kind.free_ways && random.uniform(0.0, 1.0) < 0.6;
    const bool infinite = kind.forbidden && random.uniform(0.0, 1.0) < 0.1;
    const double cost = nothing ? 0.0 : costOf(random.uniform(0.0, 0.1));
    field.locale.push_back(infinite ? std::numeric_limits<double>::infinity() : cost);
    if (kind.access) field.character.push_back(static_cast<float>(random.uniform(0.5, 3.0)));
  }
  field.locale[at(start)] = costOf(random.uniform(0.0, 0.1));
  const double per_step = kind.free_ways ? 0.0 : random.uniform(0.01, 0.1);
  const double risk = random.uniform(0.0, 0.1);
  for (Direction d = 0; d < kDirections; ++d) {
    const double length = stepLength(d);
    field.locale_in[at(d)] = kind.rate ? 0.35 * length : 1.0;
    field.locale_out[at(d)] = kind.rate ? 0.35 * length : 0.0;
    field.action[at(d)] = kind.rate ? length * costOf(per_step) : costOf(per_step * length);
    for (Direction p = 0; p < kDirections; ++p)
      field.turn[at(p)][at(d)] = turnCost(kind.turns, p, d, risk, random);
  }
  return {Lattice(shape, kind.connectivity, free), std::move(field), start};
}

}  // namespace tautline::planning::testing
