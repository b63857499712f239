#include "supervision/authority.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using A = AckResult;
using C = Condition;

constexpr std::int64_t kAnna = 11;
constexpr std::int64_t kBert = 22;

/// What is to happen, stated apart from the code.
enum class Rule { kAnyone, kHolderOrFree, kForce, kRelease };

struct Asked {
  OperatorCommand command;
  Rule rule;
};

std::vector<Asked> everyCommand() {
  std::vector<Asked> all;
  for (const auto& r : kRequestNames) {
    if (r.value == Request::kNone) continue;
    const std::string name = r.name;
    const bool safe =
        name == "hold" || name == "stop" || name == "estop" || name == "land" || name == "return";
    all.push_back({{.request = r.value}, safe ? Rule::kAnyone : Rule::kHolderOrFree});
  }
  all.push_back({{.service = Service::kTakeLease}, Rule::kHolderOrFree});
  all.push_back({{.service = Service::kForceLease}, Rule::kForce});
  all.push_back({{.service = Service::kReleaseLease}, Rule::kRelease});
  all.push_back({{.service = Service::kSetParameter}, Rule::kHolderOrFree});
  all.push_back({{.service = Service::kClearFaults}, Rule::kHolderOrFree});
  return all;
}

/// An authority whose lease Anna took `age` ago and did nothing since; no lease without her.
struct Scene {
  Authority authority{AuthorityConfig{}};
  Time now{seconds(50)};

  explicit Scene(bool held, Duration age = {}) {
    authority.update(now, Mode::kStandby, {}, {});
    if (held) {
      EXPECT_EQ(authority.decide(now, {.session = kAnna,
                                       .service = Service::kTakeLease,
                                       .name = operatorName("anna")}),
                A::kAccepted);
    }
    pass(age);
  }
  void pass(Duration d, Mode mode = Mode::kStandby) {
    now += d;
    authority.update(now, mode, {}, {});
  }
  void beat(std::int64_t session, Mode mode = Mode::kStandby) {
    authority.update(now, mode, Heartbeat{session, {}}, {});
  }
  void move(std::int64_t session, Mode mode, Sticks sticks) {
    sticks.session = session;
    authority.update(now, mode, {}, sticks);
  }
  A ask(std::int64_t session, OperatorCommand command) {
    command.session = session;
    command.name = operatorName(session == kAnna ? "anna" : "bert");
    return authority.decide(now, command);
  }
  std::int64_t holder() const { return authority.lease().session; }
  bool has(C condition, Mode mode) const { return authority.conditions(now, mode).has(condition); }
};

// Holder, other and nobody × every verb × lease of every age: who may, and who holds it then.
TEST(Authority, EveryCommandInEveryStateOfTheLease) {
  int cases = 0;
  for (const Asked& asked : everyCommand()) {
    for (const bool was_held : {false, true}) {
      for (const Duration age : {Duration(0), Duration(milliseconds(600)), Duration(seconds(9)),
                                 Duration(milliseconds(10'000)), Duration(milliseconds(10'010)),
                                 Duration(seconds(100))}) {
        for (const std::int64_t who : {kAnna, kBert}) {
          Scene scene(was_held, age);
          const bool held = was_held && age <= seconds(10);
          ASSERT_EQ(scene.holder(), held ? kAnna : 0);
          const bool his = held && who == kAnna;
          const A result = scene.ask(who, asked.command);
          const std::string what = std::string(verbOf(asked.command)) +
                                   (held ? " held " : " free ") + std::to_string(toSeconds(age)) +
                                   " by " + std::to_string(who);
          ++cases;
          const bool may =
              asked.rule == Rule::kAnyone || asked.rule == Rule::kForce || !held || his;
          EXPECT_EQ(result, may ? A::kAccepted : A::kNotHolder) << what;
          std::int64_t then = held ? kAnna : 0;
          if (asked.rule == Rule::kForce || (asked.rule == Rule::kHolderOrFree && !held))
            then = who;
          if (asked.rule == Rule::kRelease && may) then = 0;
          EXPECT_EQ(scene.holder(), then) << what;
          EXPECT_EQ(scene.has(C::kNoOperator, Mode::kStandby), then == 0) << what;
          if (then == who) {
            EXPECT_EQ(scene.authority.lease().heard, scene.now) << what << ": a sign of life";
          }
        }
      }
    }
  }
  EXPECT_EQ(cases, 16 * 2 * 6 * 2);
}

TEST(Authority, AMissionPieceIsTheHoldersOrTakesAFreeLease) {
  Scene scene(false);
  EXPECT_EQ(scene.authority.decideChunk(scene.now, kAnna, operatorName("anna")), A::kAccepted);
  EXPECT_EQ(scene.holder(), kAnna);
  EXPECT_STREQ(scene.authority.lease().name.data(), "anna");
  EXPECT_EQ(scene.authority.decideChunk(scene.now, kBert, {}), A::kNotHolder);
}

TEST(Authority, NeitherRequestNorServiceIsUnknown) {
  Scene scene(false);
  EXPECT_EQ(scene.ask(kAnna, {}), A::kUnknown);
  EXPECT_EQ(scene.ask(kAnna, {.request = Request::kArm, .service = Service::kTakeLease}),
            A::kUnknown);
  for (int verb = 0; verb < 256; ++verb) {
    const auto request = static_cast<Request>(verb);
    const auto service = static_cast<Service>(verb);
    if (request > Request::kEstop) {
      EXPECT_EQ(scene.ask(kAnna, {.request = request}), A::kUnknown) << verb;
    }
    if (service > Service::kClearFaults) {
      EXPECT_EQ(scene.ask(kAnna, {.service = service}), A::kUnknown) << verb;
    }
    if (request > Request::kEstop || service > Service::kClearFaults) {
      EXPECT_EQ(scene.holder(), 0) << verb;
    }
  }
}

TEST(Authority, OnlyTheHoldersHeartbeatKeepsTheLease) {
  Scene scene(true);
  for (int i = 0; i < 100; ++i) {
    scene.pass(seconds(1));
    scene.beat(kAnna);
  }
  EXPECT_EQ(scene.holder(), kAnna);
  for (int i = 0; i < 11; ++i) {
    scene.now += seconds(1);
    scene.beat(kBert);
  }
  EXPECT_EQ(scene.holder(), 0);
  EXPECT_EQ(scene.authority.change().event, LeaseEvent::kExpired);
  EXPECT_STREQ(scene.authority.change().from.data(), "anna");
}

TEST(Authority, ATakeOverNamesBoth) {
  Scene scene(true);
  ASSERT_EQ(scene.ask(kBert, {.service = Service::kForceLease}), A::kAccepted);
  EXPECT_EQ(scene.authority.change().event, LeaseEvent::kTakenOver);
  EXPECT_STREQ(scene.authority.change().from.data(), "anna");
  EXPECT_STREQ(scene.authority.change().to.data(), "bert");
  EXPECT_EQ(scene.ask(kAnna, {.request = Request::kArm}), A::kNotHolder);
}

TEST(Authority, InTeleopHalfASecondOfSilenceIsALoss) {
  Scene scene(true);
  scene.pass(milliseconds(500), Mode::kTeleop);
  EXPECT_FALSE(scene.has(C::kOperatorLost, Mode::kTeleop));
  scene.pass(milliseconds(10), Mode::kTeleop);
  EXPECT_TRUE(scene.has(C::kOperatorLost, Mode::kTeleop));
  // It is still one in the failsafe that follows, past the end of the lease …
  scene.pass(seconds(30), Mode::kFailsafe);
  EXPECT_TRUE(scene.has(C::kOperatorLost, Mode::kFailsafe));
  EXPECT_TRUE(scene.has(C::kNoOperator, Mode::kFailsafe));
  // … until an operator is there again.
  EXPECT_EQ(scene.ask(kBert, {.service = Service::kTakeLease}), A::kAccepted);
  EXPECT_FALSE(scene.has(C::kOperatorLost, Mode::kFailsafe));
}

TEST(Authority, SilenceElsewhereIsNoLoss) {
  for (const auto& mode : kModeNames) {
    if (mode.value == Mode::kTeleop) continue;
    Scene scene(true);
    scene.pass(seconds(60), mode.value);
    EXPECT_FALSE(scene.has(C::kOperatorLost, mode.value)) << mode.name;
  }
}

TEST(Authority, AMissionGoesOnOrHoldsAsConfigured) {
  for (const WithoutOperator choice : {WithoutOperator::kGoOn, WithoutOperator::kHold}) {
    AuthorityConfig config;
    config.auto_without_operator = choice;
    Scene scene(true);
    scene.authority.configure(config);
    scene.pass(seconds(10), Mode::kAuto);
    EXPECT_FALSE(scene.has(C::kOperatorLost, Mode::kAuto));
    scene.pass(milliseconds(10), Mode::kAuto);
    EXPECT_EQ(scene.has(C::kOperatorLost, Mode::kAuto), choice == WithoutOperator::kHold);
  }
}

TEST(Authority, SticksCountWhileFreshAndHeldAndTheHolders) {
  Scene scene(true);
  const Sticks up{.dead_man = true, .rates = {.elevation = 0.1}};
  EXPECT_FALSE(scene.authority.rates(scene.now)) << "none yet";
  EXPECT_TRUE(scene.has(C::kTeleopStale, Mode::kTeleop));
  scene.move(kBert, Mode::kTeleop, up);
  EXPECT_FALSE(scene.authority.rates(scene.now)) << "not the holder's";
  scene.move(kAnna, Mode::kTeleop, up);
  ASSERT_TRUE(scene.authority.rates(scene.now));
  EXPECT_EQ(scene.authority.rates(scene.now)->elevation, 0.1);
  EXPECT_FALSE(scene.has(C::kTeleopStale, Mode::kTeleop));
  scene.pass(milliseconds(200), Mode::kTeleop);
  EXPECT_TRUE(scene.authority.rates(scene.now));
  scene.pass(milliseconds(10), Mode::kTeleop);
  EXPECT_FALSE(scene.authority.rates(scene.now));
  EXPECT_TRUE(scene.has(C::kTeleopStale, Mode::kTeleop));
  // Released: zero at once, and not stale.
  scene.move(kAnna, Mode::kTeleop, up);
  scene.move(kAnna, Mode::kTeleop, {.dead_man = false, .rates = up.rates});
  EXPECT_FALSE(scene.authority.rates(scene.now));
  EXPECT_FALSE(scene.has(C::kTeleopStale, Mode::kTeleop));
}

TEST(Authority, SticksOfTheOneBeforeEndWithTheLease) {
  Scene scene(true);
  scene.move(kAnna, Mode::kTeleop, {.dead_man = true, .rates = {.length = 0.2}});
  ASSERT_TRUE(scene.authority.rates(scene.now));
  ASSERT_EQ(scene.ask(kBert, {.service = Service::kForceLease}), A::kAccepted);
  EXPECT_FALSE(scene.authority.rates(scene.now));
}

TEST(Authority, SticksMovedOnlyInAMissionBeyondTheDeadBandWithTheDeadMan) {
  const double band = AuthorityConfig{}.stick_dead_band;
  double TeleopRates::*const axes[] = {&TeleopRates::length, &TeleopRates::elevation,
                                       &TeleopRates::azimuth, &TeleopRates::yaw,
                                       &TeleopRates::gimbal_pitch};
  for (const auto axis : axes) {
    for (const double rate : {band + 1e-9, -band - 1e-9, band, 0.0}) {
      for (const bool dead_man : {false, true}) {
        for (const std::int64_t who : {kAnna, kBert}) {
          Scene scene(true);
          Sticks sticks{.dead_man = dead_man, .rates = {}};
          sticks.rates.*axis = rate;
          scene.move(who, Mode::kAuto, sticks);
          EXPECT_EQ(scene.has(C::kSticksMoved, Mode::kAuto),
                    who == kAnna && dead_man && std::abs(rate) > band);
          EXPECT_FALSE(scene.has(C::kSticksMoved, Mode::kTeleop));
          scene.pass(milliseconds(10), Mode::kAuto);
          EXPECT_FALSE(scene.has(C::kSticksMoved, Mode::kAuto)) << "of that cycle only";
        }
      }
    }
  }
}

}  // namespace
}  // namespace tautline
