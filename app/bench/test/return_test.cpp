// Ways back in the whole simulated machine, among obstacles and in gusts: RETURN, BACKUP, LAND over
// contacts.

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "app/bench/test/bench_flight.h"
#include "control/segment.h"

namespace tautline::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A moment of the mission: this long after that waypoint has become the target.
struct Moment {
  int waypoint;
  Duration after;
};

/// config/missions/two_contacts: contact 1 is made when waypoint 3 becomes the target, contact 2
/// with waypoint 5; they come off with 8 and 10.
const std::vector<Moment> kMoments{
    {1, seconds(1)},       {2, seconds(2)},        {3, milliseconds(20)}, {3, seconds(1)},
    {4, seconds(1)},       {5, milliseconds(20)},  {5, seconds(1)},       {6, milliseconds(500)},
    {7, seconds(1)},       {8, milliseconds(20)},  {9, milliseconds(20)}, {10, milliseconds(20)},
    {10, seconds(2)},      {11, milliseconds(500)}};

LockstepConfig gusty(std::uint64_t seed, LockstepConfig (*config)(const std::string&,
                                                                  std::uint64_t)) {
  LockstepConfig out = config("two_contacts", seed);
  out.sim.wind.gust = 0.2;
  return out;
}

LockstepConfig fotokite(const std::string& scene, std::uint64_t seed) {
  return benchConfig(scene, seed);
}

/// How far the drone is from where it has been, by the plant's own truth.
class TrueTrack {
 public:
  void add(const Eigen::Vector3d& p) {
    constexpr double kStep = 0.02;  // [m]
    if (points_.empty() || (p - points_.back()).norm() > kStep) points_.push_back(p);
  }
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < points_.size(); ++i)
      least = std::min(least, projectOnSegment(p, points_[i - 1], points_[i]).cross_track);
    return least;
  }

 private:
  std::vector<Eigen::Vector3d> points_;
};

struct Way {
  int cycles{0};
  double sum{0.0};
  double largest{0.0};
  Duration time{};
  void add(double deviation) {
    ++cycles;
    sum += deviation;
    largest = std::max(largest, deviation);
  }
};

/// A flight with two contacts, up to a moment of it.
class TwoContacts : public BenchFlight {
 public:
  explicit TwoContacts(const LockstepConfig& config) : BenchFlight(config) {
    each_cycle = [this] {
      if (coming_back_) {
        if (++cycle_ % 10 == 0) way_.add(track_.distance(truth().p_WD));
      } else if (!truth().on_ground) {
        track_.add(truth().p_WD);
      }
    };
    home_ = config.station.core.guidance;
    home_.home_position_m = *config.world.start;
    EXPECT_TRUE(takeOff());
    EXPECT_TRUE(navigate(*plan_.plan));
  }

  void flyTo(const Moment& moment) {
    EXPECT_TRUE(until([&] { return output().mission.waypoint == moment.waypoint; }, seconds(200)));
    wait(moment.after);
  }

  /// From the request to the end of the mode.
  const Way& comeBack(Request request, Mode end) {
    coming_back_ = true;
    const Time start = bench->now();
    EXPECT_TRUE(ask(request));
    EXPECT_TRUE(until(end, seconds(150))) << nameOf(mode(), kModeNames);
    way_.time = bench->now() - start;
    return way_;
  }

  [[nodiscard]] double fromHome() const {
    const Eigen::Vector3d above(0, home_.takeoff_height_m, 0);
    return (truth().p_WD - home_.home_position_m - above).norm();
  }
  [[nodiscard]] const MissionPlan& plan() const { return *plan_.plan; }
  [[nodiscard]] const Eigen::Vector3d& home() const { return home_.home_position_m; }

 private:
  Mission plan_ = mission("two_contacts");
  GuidanceConfig home_;
  TrueTrack track_;
  Way way_;
  bool coming_back_{false};
  int cycle_{0};
};

void expectHomeAndFree(const TwoContacts& flight) {
  EXPECT_FALSE(flight.truth().crashed)
      << nameOf(flight.truth().crash_reason, sim::kCrashReasonNames);
  EXPECT_EQ(flight.output().anchor.contact_count, 0);
  EXPECT_EQ(flight.truth().contact_count, 0) << "the tether itself";
  EXPECT_LT(flight.fromHome(), 0.35);
}

/// RETURN at each of the moments; prints what it measured.
void returnFrom(const std::vector<Moment>& moments, std::uint64_t first_seed,
                std::uint64_t last_seed) {
  Way all;
  double longest = 0.0;
  double time = 0.0;
  int flights = 0;
  int good = 0;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    for (std::uint64_t seed = first_seed; seed <= last_seed; ++seed) {
      SCOPED_TRACE("moment " + std::to_string(m) + ", seed " + std::to_string(seed));
      TwoContacts flight(gusty(seed, fotokite));
      flight.flyTo(moments[m]);
      const Way& way = flight.comeBack(Request::kReturn, Mode::kHold);
      expectHomeAndFree(flight);
      ++flights;
      good += ::testing::Test::HasFailure() ? 0 : 1;
      all.cycles += way.cycles;
      all.sum += way.sum;
      all.largest = std::max(all.largest, way.largest);
      time += toSeconds(way.time);
      longest = std::max(longest, toSeconds(way.time));
    }
  }
  std::printf(
      "RETURN: %d of %d; from the flown path %.3f m on average, %.3f m at most; %.1f s on average, "
      "%.1f s at most\n",
      good, flights, all.sum / std::max(1, all.cycles), all.largest, time / flights, longest);
}

TEST(Return, UndoesTheContactsFromEveryMoment) { returnFrom(kMoments, 1, 1); }

}  // namespace
}  // namespace tautline::bench
