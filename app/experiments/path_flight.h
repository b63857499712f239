#pragma once

/// @file
/// A path of config/missions flown by one law, and what is measured of it: dissertation 6.2. Not
/// real-time safe.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/experiments/setup.h"
#include "app/experiments/tracked_flight.h"
#include "common/plot/figure.h"

namespace tautline::experiments {

/// The published laws on the published station, and ours on ours.
enum class Primitive : std::uint8_t { kPosition, kVelocity, kTautline };
inline constexpr std::array kPrimitives{Primitive::kPosition, Primitive::kVelocity,
                                        Primitive::kTautline};
[[nodiscard]] const char* nameOf(Primitive primitive) noexcept;

/// Between waypoints, along the axis that moves most [m].
inline constexpr std::array kIntervals{0.2, 0.5, 1.0, 1.5, 3.0};

/// A flight along a path: what is kept of it.
struct PathFigures {
  bool completed{false};
  std::string reasons;  ///< Conditions that ended the mission.
  double mean{0.0};     ///< Cross-track error, from the first waypoint to the end [m].
  double max{0.0};      ///< [m]
  double turn{0.0};     ///< Smoothness: see meanTurn() [deg].
  double bulge{0.0};    ///< Of the first leg: see bulge() [m].
  double at_axis{0.0};  ///< Longest stay within kAxisReach of the axis through the reel [s].
  std::vector<Eigen::Vector3d> track;  ///< 0.1 m apart; empty where nobody draws it.
};
inline constexpr double kAxisReach = 0.35;  // [m]

/// Flies `path` ("path1", "path2") with waypoints every `interval` [m] and measures; `limit` is of
/// the whole flight. JSON of PathFigures.
[[nodiscard]] nlohmann::json flyPath(const Setup& setup, Primitive primitive,
                                     const std::string& path, double interval, std::uint64_t trial,
                                     Duration limit, bool keep_track);
[[nodiscard]] PathFigures pathFigures(const nlohmann::json& json);

/// The path's corners: waypoints of its mission with the widest interval, in W [m].
[[nodiscard]] std::vector<Eigen::Vector3d> pathCorners(const Setup& setup, const std::string& path);

/// "path1 position 0.2 m #1"
[[nodiscard]] std::string pathTrial(const std::string& path, Primitive primitive, double interval,
                                    std::uint64_t trial);

/// Points of a track, `spacing` [m] apart as the crow flies: what turns within that is wobble.
[[nodiscard]] std::vector<Eigen::Vector3d> resampled(const std::vector<Eigen::Vector3d>& track,
                                                     double spacing);
/// Mean angle between consecutive segments [deg]; 0 with fewer than two.
[[nodiscard]] double meanTurn(const std::vector<Eigen::Vector3d>& points);
/// Largest horizontal distance of the track to the straight line between its own ends [m].
[[nodiscard]] double bulge(const std::vector<Eigen::Vector3d>& track);

/// Tracks seen from above, one panel an interval, the laws' colours.
struct DrawnTrack {
  Primitive primitive;
  std::vector<Eigen::Vector3d> points;
};
[[nodiscard]] plot::Panel trackPanel(const std::string& title,
                                     const std::vector<Eigen::Vector3d>& ideal,
                                     const std::vector<DrawnTrack>& tracks);
[[nodiscard]] plot::Colour colourOf(Primitive primitive) noexcept;

}  // namespace tautline::experiments
