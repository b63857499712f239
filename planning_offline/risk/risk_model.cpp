#include "planning_offline/risk/risk_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "common/error.h"
#include "planning_offline/field/parallel.h"
#include "planning_offline/risk/element_laws.h"

namespace tautline::planning {
namespace {

constexpr std::array kLayerElements{RiskElement::kDynamicThreat, RiskElement::kVerticality,
                                    RiskElement::kInclination,   RiskElement::kTerrain,
                                    RiskElement::kSurface,       RiskElement::kSlippage};

std::size_t at(CellIndex i) { return static_cast<std::size_t>(i); }
std::size_t at(RiskElement e) { return static_cast<std::size_t>(e); }

void checkLayerValues(const VoxelMap& map, const MapLayer& layer) {
  if (layer.values.size() != map.shape.size()) {
    throw InputError({.file = map.file,
                      .key = layer.name,
                      .problem = "the layer has " + std::to_string(layer.values.size()) +
                                 " values, the map " + std::to_string(map.shape.size()) + " cells",
                      .allowed = "one value a cell"});
  }
  for (std::size_t i = 0; i < layer.values.size(); ++i) {
    if (kProbability.contains(layer.values[i])) continue;
    const Eigen::Vector3i c = map.shape.cell(static_cast<CellIndex>(i));
    throw InputError({.file = map.file,
                      .key = layer.name,
                      .problem = "is " + std::to_string(layer.values[i]) + " in cell (" +
                                 std::to_string(c.x()) + ", " + std::to_string(c.y()) + ", " +
                                 std::to_string(c.z()) + ")",
                      .allowed = "0 to 1"});
  }
}

std::string layerNames() {
  std::string names;
  for (const RiskElement e : kLayerElements)
    names += (names.empty() ? "" : ", ") + std::string(nameOf(e, kRiskElementNames));
  return names;
}

}  // namespace

FieldRequest neededFields(const RiskParams& params, const VoxelMap& map) {
  const bool access = isOn(params, RiskElement::kAccess);
  const bool access_width = access && params.access.character == AccessCharacter::kWidth;
  FieldRequest request;
  request.distance = isOn(params, RiskElement::kDistance);
  request.width = isOn(params, RiskElement::kScale) || access_width;
  request.visibility = isOn(params, RiskElement::kVisibility) || (access && !access_width);
  request.visibility_directions = params.visibility.directions;
  request.visibility_cap = params.visibility.cap;
  // A cell beyond where the risk ends, so that values at the cap have none. Access judges widths
  // of any size: the request's own cap stays.
  const double distance_end = params.distance.member.none + params.distance.tolerance;
  request.distance_cap = std::max(distance_end, 0.0) + map.resolution;
  if (!access_width) {
    request.width_cap = params.scale.member.none * params.scale.agent_dimension + map.resolution;
  }
  return request;
}

RiskModel::RiskModel(std::shared_ptr<const VoxelMap> map, MapFields fields, RiskParams params,
                     std::shared_ptr<TautString> string)
    : map_(std::move(map)),
      fields_(std::move(fields)),
      params_(std::move(params)),
      string_(std::move(string)) {
  const std::size_t cells = map_->shape.size();
  const FieldRequest needed = neededFields(params_, *map_);
  TAUTLINE_CHECK(!needed.distance || fields_.distance.size() == cells);
  TAUTLINE_CHECK(!needed.width || fields_.width.size() == cells);
  TAUTLINE_CHECK(!needed.visibility || fields_.visibility.size() == cells);
  for (const auto& entry : kRiskElementNames) {
    const bool tether =
        entry.value == RiskElement::kTetherLength || entry.value == RiskElement::kContacts;
    if (isOn(params_, entry.value) && !(tether && !string_)) enabled_.push_back(entry.value);
  }
  readLayers();
  makeLocaleCosts();
  makeStepCosts();
}

void RiskModel::readLayers() {
  for (const MapLayer& layer : map_->layers) {
    const auto* const element = std::find_if(
        kLayerElements.begin(), kLayerElements.end(),
        [&layer](RiskElement e) { return layer.name == nameOf(e, kRiskElementNames); });
    if (element == kLayerElements.end()) {
      throw InputError({.file = map_->file,
                        .key = layer.name,
                        .problem = "no risk element reads a layer of this name",
                        .allowed = layerNames()});
    }
    checkLayerValues(*map_, layer);
    layers_[at(*element)] = &layer.values;
  }
}

void RiskModel::makeLocaleCosts() {
  costs_.locale.assign(map_->shape.size(), 0.0);
  const CellIndex slice = map_->shape.nx * map_->shape.ny;
  const auto add_slice = [this, slice](int z) {
    for (const RiskElement e : enabled_) {
      if (depthOf(e) != RiskDepth::kLocale) continue;
      for (CellIndex i = z * slice; i < (z + 1) * slice; ++i) {
        if (const double r = localeRisk(e, i); r > 0.0) costs_.locale[at(i)] += costOfRisk(r);
      }
    }
  };
  constexpr std::size_t kWorthThreads = 100'000;
  const int threads = map_->shape.size() < kWorthThreads ? 1 : 0;
  const bool complete =
      parallelFor(map_->shape.nz, threads, Progress(), {"locale risk"}, add_slice);
  TAUTLINE_CHECK(complete);  // nobody can cancel it
}

void RiskModel::makeStepCosts() {
  const bool rate = params_.mode == RiskMode::kRate;
  costs_.start_factor = rate ? 0.0 : 1.0;
  for (Direction d = 0; d < kDirections; ++d) {
    const auto k = static_cast<std::size_t>(d);
    const double length = map_->resolution * stepLength(d);
    costs_.locale_in[k] = rate ? length / (2.0 * params_.reference_step) : 1.0;
    costs_.locale_out[k] = rate ? costs_.locale_in[k] : 0.0;
    costs_.action[k] = actionLengthCost(params_, length);
    const Eigen::Vector3d action = map_->resolution * stepOf(d).cast<double>();
    for (Direction p = 0; p < kDirections; ++p) {
      costs_.turn[static_cast<std::size_t>(p)][k] =
          turnCost(params_, map_->resolution * stepOf(p).cast<double>(), action);
    }
  }
  if (isOn(params_, RiskElement::kAccess)) {
    costs_.character =
        params_.access.character == AccessCharacter::kWidth ? fields_.width : fields_.visibility;
  }
}

double RiskModel::layer(RiskElement element, CellIndex cell) const noexcept {
  const std::vector<double>* values = layers_[at(element)];
  return values == nullptr ? 0.0 : (*values)[at(cell)];
}

double RiskModel::character(CellIndex cell) const noexcept {
  return static_cast<double>(costs_.character[at(cell)]);
}

double RiskModel::localeRisk(RiskElement element, CellIndex cell) const {
  if (!isOn(params_, element)) return 0.0;
  switch (element) {
    case RiskElement::kDistance:
      return distanceRisk(params_, static_cast<double>(fields_.distance[at(cell)]));
    case RiskElement::kScale:
      return scaleRisk(params_, static_cast<double>(fields_.width[at(cell)]));
    case RiskElement::kVisibility:
      return visibilityRisk(params_, static_cast<double>(fields_.visibility[at(cell)]));
    case RiskElement::kDynamicThreat:
      return threatRisk(params_, layer(element, cell));
    case RiskElement::kSingularity:
      if (!map_->reel) return 0.0;
      return singularityRisk(params_, elevationOf(*map_->reel, map_->centre(cell)));
    case RiskElement::kVerticality:
      return layerRisk(params_, params_.verticality, layer(element, cell));
    case RiskElement::kInclination:
      return layerRisk(params_, params_.lateral_inclination, layer(element, cell));
    case RiskElement::kTerrain:
      return layerRisk(params_, params_.terrain_stability, layer(element, cell));
    case RiskElement::kSurface:
      return layerRisk(params_, params_.surface, layer(element, cell));
    default:
      TAUTLINE_CHECK(depthOf(element) == RiskDepth::kLocale);
      return 0.0;
  }
}

bool RiskModel::hasTether() const noexcept {
  const TetherLimits& limits = params_.tether_limits;
  return string_ != nullptr &&
         (isOn(params_, RiskElement::kTetherLength) || isOn(params_, RiskElement::kContacts) ||
          limits.length_max > 0.0 || limits.contacts_max >= 0 || limits.elevation_min > -90.0 ||
          !map_->no_contact.empty());
}

bool RiskModel::hasAccumulators() const noexcept {
  return isOn(params_, RiskElement::kSlippage) || isOn(params_, RiskElement::kBattery);
}

double RiskModel::accessCost(CellIndex u, CellIndex v) const noexcept {
  if (costs_.character.empty()) return 0.0;
  const double lost = character(u) - character(v);
  return lost > 0.0 ? planning::accessCost(params_, lost) : 0.0;
}

double RiskModel::stepCost(CellIndex u, Direction incoming, Direction d,
                           CellIndex v) const noexcept {
  const auto k = static_cast<std::size_t>(d);
  const double left =
      costs_.locale_out[k] > 0.0 ? costs_.locale_out[k] * costs_.locale[at(u)] : 0.0;
  return left + costs_.locale_in[k] * costs_.locale[at(v)] + costs_.action[k] +
         costs_.turn[static_cast<std::size_t>(incoming)][k] + accessCost(u, v);
}

double RiskModel::startCost(CellIndex start) const noexcept {
  return startShare(costs_.locale[at(start)]);
}

double RiskModel::tetherCost(double length, int contacts) const noexcept {
  return costOfRisk(tetherLengthRisk(params_, length)) +
         costOfRisk(contactsRisk(params_, contacts));
}

double RiskModel::overStep(double before, double after, double step) const noexcept {
  return params_.mode == RiskMode::kPerState
             ? after
             : (before + after) * (step / (2.0 * params_.reference_step));
}

double RiskModel::startShare(double cost) const noexcept {
  return params_.mode == RiskMode::kPerState || std::isinf(cost) ? cost : 0.0;
}

bool RiskModel::elevationAllowed(const Eigen::Vector3d& anchor,
                                 const Eigen::Vector3d& position) const noexcept {
  return params_.tether_limits.allowsElevation(anchor, position);
}

BrokenLimits RiskModel::brokenLimits(StackId stack, const Eigen::Vector3d& position) const {
  const TetherLimits& limits = params_.tether_limits;
  return {.length = !limits.allowsLength(string_->length(stack, position)),
          .contacts = !limits.allowsContacts(string_->contactCount(stack)),
          .elevation = !elevationAllowed(string_->anchor(stack), position),
          .no_contact = string_->touchesForbidden(stack)};
}

Accumulators RiskModel::advance(const Accumulators& before, CellIndex u, CellIndex v,
                                double step) const noexcept {
  Accumulators after = before;
  after.mud += mudGathered(params_, layer(RiskElement::kSlippage, u),
                           layer(RiskElement::kSlippage, v), step);
  after.energy += energyUsed(params_, map_->centre(v) - map_->centre(u));
  return after;
}

double RiskModel::accumulatorCost(const Accumulators& at, CellIndex v) const noexcept {
  return costOfRisk(slippageRisk(params_, at.mud, layer(RiskElement::kSlippage, v))) +
         costOfRisk(batteryRisk(params_, at.energy));
}

}  // namespace tautline::planning
