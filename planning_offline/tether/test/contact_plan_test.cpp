#include "planning_offline/tether/contact_plan.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/tether/contact_tree.h"
#include "planning_offline/tether/no_contact.h"
#include "planning_offline/tether/taut_string.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// Points in cells to M.
Eigen::Vector3d at(const VoxelMap& map, double x, double y, double z) {
  return map.origin + map.resolution * Eigen::Vector3d(x, y, z);
}

double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * (b - a)).norm();
}

Points after(Points contacts, const std::vector<ContactEvent>& events) {
  for (const ContactEvent& event : events) {
    if (event.kind == ContactChange::kPush) {
      contacts.push_back(event.position);
    } else {
      EXPECT_FALSE(contacts.empty());
      EXPECT_LT((contacts.back() - event.position).norm(), 1e-12);
      contacts.pop_back();
    }
  }
  return contacts;
}

/// A planar map with one cell occupied, seen from the reel behind its corner (4, 4) in x and z.
class OnePillar : public ::testing::Test {
 protected:
  OnePillar() { walks::occupy(map_, {4, 0, 3}); }
  VoxelMap map_{walks::emptyMap({10, 1, 10})};
  Eigen::Vector3d reel_{at(map_, 1.5, 0.5, 1.5)};
};

TEST_F(OnePillar, PutsThePushInLineWithReelAndCorner) {
  // From z = 6 down past the pillar's corner (4, 4): in line at x = 8, z = 1.5 + 6.5.
  const Points path{at(map_, 8, 0.5, 9.5), at(map_, 8, 0.5, 5.5)};
  const ContactPlan plan = planContacts(map_, reel_, path);
  ASSERT_EQ(plan.states.size(), 2U);
  EXPECT_TRUE(plan.states[0].contacts.empty());
  ASSERT_EQ(plan.states[1].events.size(), 1U);
  const ContactEvent& event = plan.states[1].events[0];
  EXPECT_EQ(event.kind, ContactChange::kPush);
  EXPECT_LT((event.position - at(map_, 4, 0.5, 4)).norm(), 1e-9);
  EXPECT_LT((event.vehicle - at(map_, 8, 0.5, 8)).norm(), 2e-3 * map_.resolution);
  EXPECT_NEAR(event.length, (event.vehicle - reel_).norm(), 1e-6);
  EXPECT_EQ(plan.states[1].contacts.size(), 1U);
  ASSERT_TRUE(plan.states[1].frictionless_length.has_value());
  EXPECT_DOUBLE_EQ(*plan.states[1].frictionless_length, plan.states[1].length);
  EXPECT_DOUBLE_EQ(longestTether(plan), std::max(plan.states[0].length, plan.states[1].length));
}

TEST_F(OnePillar, TakesTheContactOffWhereItFormed) {
  const Points path{at(map_, 8, 0.5, 9.5), at(map_, 8, 0.5, 5.5), at(map_, 8, 0.5, 9.5)};
  const ContactPlan plan = planContacts(map_, reel_, path);
  EXPECT_TRUE(plan.states[2].contacts.empty());
  EXPECT_EQ(countEvents(plan, ContactChange::kPush), 1);
  EXPECT_EQ(countEvents(plan, ContactChange::kPop), 1);
  EXPECT_LT((plan.states[1].events[0].vehicle - plan.states[2].events[0].vehicle).norm(),
            4e-3 * map_.resolution);
}

TEST_F(OnePillar, FindsEachOfSeveralEventsOnALeg) {
  walks::occupy(map_, {6, 0, 3});
  const Points path{at(map_, 8.5, 0.5, 9.5), at(map_, 8.5, 0.5, 2.5)};
  const ContactPlan plan = planContacts(map_, reel_, path);
  const std::vector<ContactEvent>& events = plan.states[1].events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_LT((events[0].position - at(map_, 4, 0.5, 4)).norm(), 1e-9);
  EXPECT_LT((events[0].vehicle - at(map_, 8.5, 0.5, 8.5)).norm(), 4e-3 * map_.resolution);
  EXPECT_LT((events[1].position - at(map_, 7, 0.5, 4)).norm(), 1e-9);
  EXPECT_LT((events[1].vehicle - at(map_, 8.5, 0.5, 4)).norm(), 4e-3 * map_.resolution);
}

TEST(ContactPlan, OfNoWaypointsHasNoStates) {
  const VoxelMap map = walks::emptyMap({4, 1, 4});
  const ContactPlan plan = planContacts(map, at(map, 1.5, 0.5, 1.5), {});
  EXPECT_TRUE(plan.states.empty());
  EXPECT_EQ(longestTether(plan), 0.0);
}

TEST(ContactPlan, RefusesAReelInsideAnObstacle) {
  VoxelMap map = walks::emptyMap({4, 4, 4});
  walks::occupy(map, {1, 1, 1});
  EXPECT_THROW((void)planContacts(map, at(map, 1.5, 1.5, 1.5), {}), InputError);
}

TEST(ContactPlan, TheLongestTetherMayBeJustBeforeAContactComesOff) {
  VoxelMap map = walks::emptyMap({10, 10, 10});
  const auto block = [&map](const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        for (int x = low.x(); x < high.x(); ++x) walks::occupy(map, {x, y, z});
      }
    }
  };
  block({2, 2, 7}, {5, 3, 9});
  block({2, 4, 2}, {3, 5, 4});
  const Points path{at(map, 0.5, 6.5, 4.5), at(map, 3.5, 6.5, 4.5), at(map, 5.5, 1.5, 7.5),
                    at(map, 6.5, 6.5, 9.5), at(map, 9.5, 6.5, 9.5)};
  const ContactPlan plan = planContacts(map, at(map, 0.5, 0.5, 0.5), path);
  ASSERT_EQ(plan.states[4].events.size(), 2U);
  const ContactEvent& pop = plan.states[4].events[0];
  EXPECT_EQ(pop.kind, ContactChange::kPop);
  double elsewhere = 0.0;
  for (const TetherState& state : plan.states) {
    elsewhere = std::max(elsewhere, state.length);
    for (const ContactEvent& event : state.events) elsewhere = std::max(elsewhere, event.length);
  }
  EXPECT_GT(pop.length_before, elsewhere + 0.1 * map.resolution);
  EXPECT_EQ(longestTether(plan), pop.length_before);
  EXPECT_EQ(pop.length, plan.states[4].events[1].length_before);
}

/// Random walks on random maps, every fourth cell a waypoint: legs of several cells.
class Walks : public ::testing::TestWithParam<bool> {
 protected:
  struct Flight {
    VoxelMap map;
    Points path;
  };
  template <class F>
  void forFlights(int count, F f) {
    walks::Random random(11);
    for (int n = 0; n < count; ++n) {
      const GridShape shape = GetParam() ? GridShape{12, 1, 12} : GridShape{7, 7, 7};
      const VoxelMap map = walks::clutteredMap(shape, GetParam() ? 8 : 10, random);
      const Lattice lattice = walks::freeLattice(map, Connectivity::kFaces);
      const Points path = walks::centres(map, walks::randomWalk(lattice, 40, random));
      SCOPED_TRACE(::testing::Message() << "flight " << n);
      f(map, path);
      if (HasFatalFailure()) return;
    }
  }
};

TEST_P(Walks, StacksAreThoseOfTheStringAndEventsLeadToThem) {
  int events = 0;
  forFlights(150, [&](const VoxelMap& map, const Points& path) {
    const ContactPlan plan = planContacts(map, path[0], path);
    const std::unique_ptr<TautString> string = makeTautString(map, path[0]);
    StackId stack = kStraight;
    Points contacts;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Eigen::Vector3d& from = path[i == 0 ? 0 : i - 1];
      stack = string->move(stack, from, path[i]);
      const TetherState& state = plan.states[i];
      ASSERT_EQ(state.contacts.size(), string->contacts(stack).size());
      EXPECT_NEAR(state.length, string->length(stack, path[i]), 1e-6);
      contacts = after(contacts, state.events);
      ASSERT_EQ(contacts.size(), state.contacts.size());
      for (std::size_t k = 0; k < contacts.size(); ++k)
        EXPECT_LT((contacts[k] - state.contacts[k]).norm(), 1e-3 * map.resolution);
      double way = 0.0;
      for (const ContactEvent& event : state.events) {
        EXPECT_LT(distanceToSegment(event.vehicle, from, path[i]), 1e-9);
        EXPECT_GE((event.vehicle - from).norm(), way - 1e-9);
        way = (event.vehicle - from).norm();
        ++events;
      }
    }
  });
  EXPECT_GT(events, 500);
}

TEST_P(Walks, ContactsFormWhereTheTetherIsInLine) {
  int pushes = 0;
  forFlights(100, [&](const VoxelMap& map, const Points& path) {
    const ContactPlan plan = planContacts(map, path[0], path);
    Points stack{path[0]};
    for (const TetherState& state : plan.states) {
      for (std::size_t i = 0; i < state.events.size(); ++i) {
        const ContactEvent& event = state.events[i];
        if (event.kind == ContactChange::kPop) {
          stack.pop_back();
          continue;
        }
        // One that a swing brings forms while the tether moves and the vehicle does not.
        const bool swung = i > 0 && state.events[i - 1].vehicle == event.vehicle;
        if (!swung) {
          EXPECT_LT(distanceToSegment(event.position, stack.back(), event.vehicle),
                    4e-3 * map.resolution);
          ++pushes;
        }
        stack.push_back(event.position);
      }
    }
  });
  EXPECT_GT(pushes, 200);
}

TEST_P(Walks, WaypointsPutInAtTheEventsChangeNothing) {
  forFlights(100, [&](const VoxelMap& map, const Points& path) {
    const ContactPlan plan = planContacts(map, path[0], path);
    Points longer;
    std::vector<std::size_t> place;
    for (const TetherState& state : plan.states) {
      for (const ContactEvent& event : state.events) {
        if (longer.back() != event.vehicle) longer.push_back(event.vehicle);
      }
      if (longer.empty() || longer.back() != state.position) longer.push_back(state.position);
      place.push_back(longer.size() - 1);
    }
    const ContactPlan again = planContacts(map, path[0], longer);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const TetherState& state = again.states[place[i]];
      ASSERT_EQ(state.contacts.size(), plan.states[i].contacts.size());
      for (std::size_t k = 0; k < state.contacts.size(); ++k)
        EXPECT_LT((state.contacts[k] - plan.states[i].contacts[k]).norm(), 1e-3 * map.resolution);
    }
    for (std::size_t i = 1; i < again.states.size(); ++i) {
      for (const ContactEvent& event : again.states[i].events)
        EXPECT_TRUE(event.vehicle == longer[i] || event.vehicle == longer[i - 1]);
    }
  });
}

TEST_P(Walks, NoPlaceOnTheWayHasALongerTether) {
  forFlights(40, [&](const VoxelMap& map, const Points& path) {
    const double longest = longestTether(planContacts(map, path[0], path));
    const std::unique_ptr<TautString> string = makeTautString(map, path[0]);
    StackId stack = kStraight;
    for (std::size_t i = 1; i < path.size(); ++i) {
      for (int k = 1; k <= 16; ++k) {
        const Eigen::Vector3d here = path[i - 1] + k / 16.0 * (path[i] - path[i - 1]);
        const StackId next = string->move(stack, path[i - 1], here);
        EXPECT_LE(string->length(next, here), longest + 1e-3 * map.resolution);
        if (k == 16) stack = next;
      }
    }
  });
}

TEST_P(Walks, EventsKnowTheTetherJustBeforeThem) {
  int jumps = 0;
  forFlights(60, [&](const VoxelMap& map, const Points& path) {
    const ContactPlan plan = planContacts(map, path[0], path);
    const std::unique_ptr<TautString> string = makeTautString(map, path[0]);
    StackId stack = kStraight;
    double seen = 0.0;  // all that states and the tethers after the events show
    for (std::size_t i = 1; i < path.size(); ++i) {
      const TetherState& state = plan.states[i];
      const double leg = (path[i] - path[i - 1]).norm();
      if (!state.events.empty()) {
        const ContactEvent& event = state.events.front();
        const double back =
            std::max((event.vehicle - path[i - 1]).norm() - 4e-3 * map.resolution, 0.0);
        const Eigen::Vector3d p = path[i - 1] + back / leg * (path[i] - path[i - 1]);
        EXPECT_NEAR(string->length(string->move(stack, path[i - 1], p), p), event.length_before,
                    5e-3 * map.resolution);
        EXPECT_LE(event.length_before, longestTether(plan));
      }
      for (const ContactEvent& event : state.events) {
        seen = std::max(seen, event.length);
        jumps += event.length_before - event.length > 0.01 * map.resolution ? 1 : 0;
      }
      seen = std::max(seen, state.length);
      stack = string->move(stack, path[i - 1], path[i]);
    }
    if (map.shape.planar()) {
      EXPECT_LE(longestTether(plan), seen + 0.01 * map.resolution);  // nothing pins it
    }
  });
  if (!GetParam()) {
    EXPECT_GT(jumps, 5);
  }
}

TEST_P(Walks, TheStringKnowsWhetherAContactTouchesAMarkedCell) {
  int touching = 0;
  walks::Random random(5);
  forFlights(60, [&](VoxelMap map, const Points& path) {
    map.no_contact.assign(map.shape.size(), 0);
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
      if (map.cells[i] == CellState::kOccupied && random() % 3 == 0) map.no_contact[i] = 1;
    }
    const std::unique_ptr<TautString> string = makeTautString(map, path[0]);
    StackId stack = kStraight;
    for (std::size_t i = 1; i < path.size(); ++i) {
      stack = string->move(stack, path[i - 1], path[i]);
      bool touches = false;
      for (const Eigen::Vector3d& contact : string->contacts(stack)) {
        for (std::size_t k = 0; k < map.cells.size(); ++k) {
          const Eigen::Vector3d away = contact - map.centre(static_cast<CellIndex>(k));
          touches = touches || (map.no_contact[k] != 0 &&
                                away.cwiseAbs().maxCoeff() < 0.50001 * map.resolution);
        }
      }
      ASSERT_EQ(string->touchesForbidden(stack), touches);
      touching += touches ? 1 : 0;
    }
  });
  EXPECT_GT(touching, 100);
}

INSTANTIATE_TEST_SUITE_P(PlaneAndSpace, Walks, ::testing::Bool(),
                         [](const auto& kind) { return kind.param ? "plane" : "space"; });

TEST(NoContactCells, AreTouchedOnTheirFacesEdgesAndCorners) {
  VoxelMap map = walks::emptyMap({4, 4, 4});
  walks::occupy(map, {1, 1, 1});
  EXPECT_FALSE(NoContactCells(map).touchedAt(at(map, 1, 1, 1)));
  map.no_contact.assign(map.shape.size(), 0);
  map.no_contact[static_cast<std::size_t>(map.shape.index({1, 1, 1}))] = 1;
  const NoContactCells cells(map);
  EXPECT_TRUE(cells.touchedAt(at(map, 1, 1, 1)));
  EXPECT_TRUE(cells.touchedAt(at(map, 2, 2, 1.5)));
  EXPECT_TRUE(cells.touchedAt(at(map, 2.000001, 1.5, 1.5)));
  EXPECT_FALSE(cells.touchedAt(at(map, 2.001, 1.5, 1.5)));
  EXPECT_TRUE(cells.touchedAt(at(map, 2.1, 2.1, 1.5), 0.1));  // put off the edge
  EXPECT_FALSE(cells.touchedAt(at(map, 2.2, 2.1, 1.5), 0.1));
  EXPECT_FALSE(cells.touchedAt(at(map, 1, 1, 2.5)));
  EXPECT_FALSE(cells.touchedAt(at(map, -3, 0, 9)));
}

TEST(ContactTree, AStackIsForbiddenFromTheMarkedContactOn) {
  VoxelMap map = walks::emptyMap({4, 4, 4});
  map.no_contact.assign(map.shape.size(), 0);
  map.no_contact[static_cast<std::size_t>(map.shape.index({1, 1, 1}))] = 1;
  ContactTree tree(at(map, 0, 0, 0), 0.0);
  tree.forbid(NoContactCells(map));
  const StackId free = tree.push(kStraight, {.edge = 1, .place = 0, .turn = 1}, at(map, 3, 0, 0));
  const StackId marked = tree.push(free, {.edge = 2, .place = 0, .turn = 1}, at(map, 2, 2, 1.5));
  const StackId beyond = tree.push(marked, {.edge = 3, .place = 0, .turn = 1}, at(map, 3, 3, 3));
  EXPECT_FALSE(tree.forbidden(kStraight));
  EXPECT_FALSE(tree.forbidden(free));
  EXPECT_TRUE(tree.forbidden(marked));
  EXPECT_TRUE(tree.forbidden(beyond));
}

}  // namespace
}  // namespace tautline::planning
