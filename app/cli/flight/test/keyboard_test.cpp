#include "app/cli/flight/keyboard.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace tautline::cli::flight {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Keys {
  KeyboardSticks sticks;
  Time now{seconds(5)};

  void press(char key) { sticks.press(key, now); }
  void pass(Duration d) {
    now += d;
    sticks.update(now);
  }
};

TEST(KeyboardSticks, EveryStickMovesBothWaysAndStopsAtItsEnd) {
  for (const StickKeys& stick : kSticks) {
    Keys keys;
    keys.press(stick.up);
    EXPECT_DOUBLE_EQ(keys.sticks.rates().*stick.rate, stick.step) << stick.name;
    for (int i = 0; i < 100; ++i) keys.press(stick.up);
    EXPECT_DOUBLE_EQ(keys.sticks.rates().*stick.rate, stick.most);
    for (int i = 0; i < 200; ++i) keys.press(stick.down);
    EXPECT_DOUBLE_EQ(keys.sticks.rates().*stick.rate, -stick.most);
    keys.press('x');
    EXPECT_EQ(keys.sticks.rates().*stick.rate, 0.0);
  }
}

TEST(KeyboardSticks, NoTwoSticksShareAKey) {
  std::string keys = " x";
  for (const StickKeys& stick : kSticks) keys += {stick.up, stick.down};
  for (const char key : keys) EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 1) << key;
}

TEST(KeyboardSticks, TheSpaceBarIsHeldWhileItRepeats) {
  Keys keys;
  EXPECT_FALSE(keys.sticks.deadManHeld());
  keys.press(' ');
  keys.pass(milliseconds(500));  // the terminal's wait before it repeats
  EXPECT_TRUE(keys.sticks.deadManHeld());
  for (int i = 0; i < 50; ++i) {
    keys.press(' ');
    keys.pass(milliseconds(33));
    ASSERT_TRUE(keys.sticks.deadManHeld());
  }
  keys.pass(milliseconds(120));
  EXPECT_FALSE(keys.sticks.deadManHeld()) << "released for 150 ms";
}

TEST(KeyboardSticks, OneStrokeIsNoHold) {
  Keys keys;
  keys.press(' ');
  keys.pass(milliseconds(699));
  EXPECT_TRUE(keys.sticks.deadManHeld());
  keys.pass(milliseconds(1));
  EXPECT_FALSE(keys.sticks.deadManHeld());
}

TEST(KeyboardSticks, ReleaseBringsTheSticksToTheMiddle) {
  Keys keys;
  keys.press('w');
  keys.press(' ');
  EXPECT_GT(keys.sticks.rates().elevation, 0.0);
  keys.pass(seconds(1));
  EXPECT_EQ(keys.sticks.rates().elevation, 0.0);
}

TEST(KeyboardSticks, ThreeKeysEnd) {
  for (const char key : {'\x03', '\x04', '\x1b'}) {
    Keys keys;
    keys.press(key);
    EXPECT_TRUE(keys.sticks.wantsToEnd());
  }
  Keys keys;
  for (int c = 32; c < 127; ++c) keys.press(static_cast<char>(c));
  EXPECT_FALSE(keys.sticks.wantsToEnd());
}

}  // namespace
}  // namespace tautline::cli::flight
