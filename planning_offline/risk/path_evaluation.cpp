#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.h"
#include "planning_offline/risk/element_laws.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// Walks a path and tells the cost of every element at each of its states, by the elements'
/// definitions.
class PathEvaluation {
 public:
  explicit PathEvaluation(const RiskModel& model)
      : model_(model), params_(model.params()), rate_(params_.mode == RiskMode::kRate) {}

  StateRisk next(const Eigen::Vector3d& position, PerElement& cost) {
    if (first_) {
      start(position, cost);
    } else {
      step(position, cost);
    }
    first_ = false;
    StateRisk state;
    state.position = position;
    double sum = 0.0;
    for (std::size_t k = 0; k < kRiskElements; ++k) {
      state.elements[k] = riskOfCost(cost[k]);
      sum += cost[k];
    }
    state.risk = riskOfCost(sum);
    if (TautString* string = model_.string()) {
      state.tether_length = string->length(stack_, position);
      state.contacts = string->contacts(stack_);
    }
    return state;
  }

 private:
  /// Cells and weights that make the value at a point.
  struct Stencil {
    std::array<CellIndex, 8> cell{};
    std::array<double, 8> weight{};
    std::size_t size{0};
    void add(CellIndex i, double w) {
      cell[size] = i;
      weight[size++] = w;
    }
  };
  static double& of(PerElement& values, RiskElement e) {
    return values[static_cast<std::size_t>(e)];
  }

  void start(const Eigen::Vector3d& position, PerElement& cost) {
    last_ = position;
    if (model_.string() != nullptr)
      stack_ = model_.string()->move(kStraight, model_.string()->reel(), position);
    here_ = stencilAt(position);
    at_last_ = stateCosts(position);
    for (std::size_t k = 0; k < kRiskElements; ++k) {
      // In rate mode there is no way yet; what is certain is so without one.
      if (!rate_ || std::isinf(at_last_[k])) cost[k] = at_last_[k];
    }
  }

  void step(const Eigen::Vector3d& position, PerElement& cost) {
    const Eigen::Vector3d action = position - last_;
    of(cost, RiskElement::kActionLength) = actionLengthCost(params_, action.norm());
    of(cost, RiskElement::kTurn) = turnCost(params_, action_, action);
    // Standing still is no turn, and the next move is judged by the one before.
    if (!action.isZero(0.0)) action_ = action;

    const Eigen::Vector3d from = last_;
    const int pieces = piecesOf(action);
    for (int j = 1; j <= pieces; ++j) {
      const double t = static_cast<double>(j) / pieces;
      addPiece(j == pieces ? position : Eigen::Vector3d(from + t * action), cost);
    }
  }

  /// Rate mode integrates in pieces of at most one cell along each axis.
  [[nodiscard]] int piecesOf(const Eigen::Vector3d& action) const {
    if (!rate_) return 1;
    constexpr double kRounding = 1e-6;
    const double cells = action.cwiseAbs().maxCoeff() / model_.map().resolution;
    return std::max(1, static_cast<int>(std::ceil(cells - kRounding)));
  }

  void addPiece(const Eigen::Vector3d& position, PerElement& cost) {
    const Eigen::Vector3d move = position - last_;
    const double length = move.norm();
    const Stencil there = stencilAt(position);
    if (isOn(params_, RiskElement::kAccess)) {
      const auto character = [this](CellIndex i) { return model_.character(i); };
      const double lost = mean(here_, character) - mean(there, character);
      of(cost, RiskElement::kAccess) += accessCost(params_, std::max(0.0, lost));
    }
    mud_ += mudGathered(params_, slipperiness(here_), slipperiness(there), length);
    energy_ += energyUsed(params_, move);
    if (model_.string() != nullptr) stack_ = model_.string()->move(stack_, last_, position);

    here_ = there;
    const PerElement after = stateCosts(position);
    for (std::size_t k = 0; k < kRiskElements; ++k)
      cost[k] += rate_ ? integral(at_last_[k], after[k], length) : after[k];
    last_ = position;
    at_last_ = after;
  }

  /// Trapezoid of the rates that go with these costs of states.
  [[nodiscard]] double integral(double before, double after, double length) const {
    const double mean = (before + after) / 2.0;
    return std::isinf(mean) ? mean : mean / params_.reference_step * length;
  }

  /// −log(1 − r) of the elements that a state has by itself: all but those of actions. Of the point
  /// that here_ belongs to.
  [[nodiscard]] PerElement stateCosts(const Eigen::Vector3d& position) const {
    PerElement costs{};
    for (const RiskElement e : model_.enabled()) {
      if (depthOf(e) != RiskDepth::kLocale) continue;
      of(costs, e) =
          mean(here_, [this, e](CellIndex i) { return costOfRisk(model_.localeRisk(e, i)); });
    }
    of(costs, RiskElement::kSlippage) =
        costOfRisk(slippageRisk(params_, mud_, slipperiness(here_)));
    of(costs, RiskElement::kBattery) = costOfRisk(batteryRisk(params_, energy_));
    if (const TautString* string = model_.string()) {
      const double taut = model_.elevationAllowed(string->anchor(stack_), position)
                              ? tetherLengthRisk(params_, string->length(stack_, position))
                              : 1.0;
      of(costs, RiskElement::kTetherLength) = costOfRisk(taut);
      of(costs, RiskElement::kContacts) = costOfRisk(
          string->touchesForbidden(stack_) ? 1.0
                                           : contactsRisk(params_, string->contactCount(stack_)));
    }
    return costs;
  }

  [[nodiscard]] double slipperiness(const Stencil& stencil) const {
    return mean(stencil, [this](CellIndex i) { return model_.layer(RiskElement::kSlippage, i); });
  }

  /// Per state the cell that holds the point; in rate mode the cells of its kind around.
  [[nodiscard]] Stencil stencilAt(const Eigen::Vector3d& point) const {
    const VoxelMap& map = model_.map();
    const CellIndex own = map.indexAt(point);
    TAUTLINE_CHECK(own != kNoCell);
    Stencil stencil;
    stencil.add(own, 1.0);
    if (!rate_) return stencil;

    // Towards the neighbour along each axis: 0 at the centre, ½ at the face.
    const Eigen::Vector3d offset = (point - map.centre(own)) / map.resolution;
    const Eigen::Vector3i home = map.shape.cell(own);
    const auto kind = map.cells[static_cast<std::size_t>(own)];
    stencil.size = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      Eigen::Vector3i cell = home;
      double weight = 1.0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double away = std::abs(offset[axis]);
        const bool beyond = ((corner >> axis) & 1U) != 0;
        if (beyond) cell[axis] += offset[axis] > 0.0 ? 1 : -1;
        weight *= beyond ? away : 1.0 - away;
      }
      constexpr double kRounding = 1e-9;
      if (weight < kRounding || !map.shape.contains(cell)) continue;
      const CellIndex i = map.shape.index(cell);
      if (map.cells[static_cast<std::size_t>(i)] == kind) stencil.add(i, weight);
    }
    return stencil;  // the own cell first: its weight is at least 1/8
  }

  template <class ValueOf>
  [[nodiscard]] static double mean(const Stencil& stencil, ValueOf value_of) {
    double sum = 0.0;
    double weight = 0.0;
    for (std::size_t i = 0; i < stencil.size; ++i) {
      const double value = value_of(stencil.cell[i]);
      if (std::isinf(value)) {
        if (i == 0) return value;
        continue;
      }
      sum += stencil.weight[i] * value;
      weight += stencil.weight[i];
    }
    return sum / weight;
  }

  const RiskModel& model_;
  const RiskParams& params_;
  bool rate_;
  bool first_{true};
  Eigen::Vector3d last_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d action_{Eigen::Vector3d::Zero()};  ///< The last move; zero before the first.
  Stencil here_;                                     ///< Of last_.
  PerElement at_last_{};                             ///< stateCosts() there.
  double mud_{0.0};
  double energy_{0.0};
  StackId stack_{kStraight};
};

RiskReport RiskModel::evaluate(std::span<const Eigen::Vector3d> points) const {
  RiskReport report;
  PathEvaluation path(*this);
  for (const Eigen::Vector3d& point : points) {
    PerElement cost{};
    report.states.push_back(path.next(point, cost));
    for (std::size_t k = 0; k < kRiskElements; ++k) report.element_cost[k] += cost[k];
  }
  for (const double cost : report.element_cost) report.cost += cost;
  report.risk = riskOfCost(report.cost);
  return report;
}

RiskReport RiskModel::evaluate(std::span<const CellIndex> cells) const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(cells.size());
  for (const CellIndex i : cells) points.push_back(map_->centre(i));
  return evaluate(points);
}

}  // namespace tautline::planning
