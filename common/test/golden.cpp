#include "common/test/golden.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace tautline::golden {
namespace {

using nlohmann::json;

json cases(const std::string& name) {
  const std::string path = TAUTLINE_SOURCE_DIR "/common/test/golden/" + name + ".json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return json::parse(file).at("cases");
}

template <class Matrix>
Matrix matrix(const json& rows) {
  Matrix m;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      m(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
    }
  }
  return m;
}

Eigen::Vector3d vector3(const json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

}  // namespace

std::vector<Polar> loadPolar() {
  std::vector<Polar> out;
  for (const json& c : cases("polar")) {
    out.push_back({.p = vector3(c.at("xyz")),
                   .L = c.at("L"),
                   .theta = c.at("theta"),
                   .phi = c.at("phi"),
                   .J = matrix<Eigen::Matrix3d>(c.at("J"))});
  }
  return out;
}

std::vector<Forward> loadForward() {
  std::vector<Forward> out;
  for (const json& c : cases("catenary_forward")) {
    out.push_back(
        {.L = c.at("Ls"),
         .theta_D = c.at("theta"),
         .T_D = c.at("T"),
         .w = c.at("w"),
         .phi = c.at("phi"),
         .r = c.at("dx"),
         .h = c.at("dy"),
         .H = c.at("H"),
         .V_D = c.at("Vt"),
         .V_A = c.at("Vb"),
         .T_A = c.at("Tb"),
         .theta_A = c.at("theta_b"),
         .chord = c.at("chord"),
         .chord_elevation = c.at("chord_elev"),
         .p = vector3(c.at("xyz")),
         .J = c.at("jac_LsThetaT").is_null()
                  ? std::nullopt
                  : std::optional(matrix<Eigen::Matrix<double, 2, 3>>(c.at("jac_LsThetaT")))});
  }
  return out;
}

std::vector<Inverse> loadInverse() {
  std::vector<Inverse> out;
  for (const json& c : cases("catenary_inverse")) {
    const bool feasible = c.at("feasible");
    const auto value = [&](const char* key) { return feasible ? c.at(key).get<double>() : 0.0; };
    out.push_back(
        {.r = c.at("dx"),
         .h = c.at("dy"),
         .T = c.at("T"),
         .w = c.at("w"),
         .at_drone = c.at("end") == "top",
         .feasible = feasible,
         .T_min = c.contains("T_min") ? std::optional(c.at("T_min").get<double>()) : std::nullopt,
         .L = value("Ls"),
         .H = value("H"),
         .theta_D = value("theta_t"),
         .theta_A = value("theta_b"),
         .T_D = value("Tt"),
         .T_A = value("Tb")});
  }
  return out;
}

std::vector<Reel> loadReel() {
  std::vector<Reel> out;
  for (const json& c : cases("reel_tension")) {
    const bool feasible = c.at("feasible");
    const auto value = [&](const char* key) { return feasible ? c.at(key).get<double>() : 0.0; };
    out.push_back({.L = c.at("Ls"),
                   .theta_D = c.at("theta"),
                   .T_A = c.at("Tb"),
                   .w = c.at("w"),
                   .feasible = feasible,
                   .T_D = value("Tt"),
                   .r = value("dx"),
                   .h = value("dy")});
  }
  return out;
}

}  // namespace tautline::golden
