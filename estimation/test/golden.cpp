#include "estimation/test/golden.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace tautline::golden {
namespace {

using nlohmann::json;

json cases(const std::string& name, const std::string& list) {
  const std::string path = TAUTLINE_SOURCE_DIR "/estimation/test/golden/" + name + ".json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return json::parse(file).at(list);
}

Literal literal(const json& c) {
  return {.L_x = c.at("Lx"),
          .L_y = c.at("Ly"),
          .theta_r = c.at("theta_r"),
          .L_r = c.at("L_r"),
          .L_s = c.at("L_s")};
}

}  // namespace

std::vector<Lean> loadLean() {
  std::vector<Lean> out;
  for (const json& c : cases("lean_tension", "cases")) {
    out.push_back({.G = c.at("G"),
                   .T = c.at("T"),
                   .theta = c.at("theta"),
                   .beta = c.at("beta"),
                   .F = c.at("F"),
                   .dlnT_dbeta = c.at("dlnT_dbeta")});
  }
  return out;
}

std::vector<Map> loadMap() {
  std::vector<Map> out;
  for (const json& c : cases("lean_tension", "map_cases")) {
    out.push_back({.G = c.at("G"),
                   .beta = c.at("beta"),
                   .theta = c.at("theta"),
                   .T_prior = c.at("T_prior"),
                   .sigma_T = c.at("sigma_T"),
                   .sigma_beta = c.at("sigma_beta"),
                   .T_map = c.at("T_map"),
                   .sigma_map = c.at("sigma_map")});
  }
  return out;
}

std::vector<Attitude> loadAttitude() {
  std::vector<Attitude> out;
  for (const json& c : cases("lean_tension", "quat_cases")) {
    const json& q = c.at("quat_abcd");
    const json& n = c.at("n_g");
    out.push_back(
        {.R_WB = Eigen::Quaterniond(q.at(0).get<double>(), q.at(1).get<double>(),
                                    q.at(2).get<double>(), q.at(3).get<double>()),
         .n = Eigen::Vector3d(n.at(0).get<double>(), n.at(1).get<double>(), n.at(2).get<double>()),
         .beta = c.at("beta")});
  }
  return out;
}

std::vector<LiteralCase> loadLiteral() {
  std::vector<LiteralCase> out;
  for (const json& c : cases("literal_dissertation_catenary", "cases")) {
    out.push_back({.theta = c.at("theta"),
                   .T = c.at("T"),
                   .w = c.at("w"),
                   .horizontal = literal(c.at("T0_eq_Tcos")),
                   .as_stated = literal(c.at("T0_eq_T"))});
  }
  return out;
}

}  // namespace tautline::golden
