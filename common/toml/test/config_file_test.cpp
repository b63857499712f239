#include "common/toml/config_file.h"

#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tautline {
namespace {

using ::testing::HasSubstr;

enum class Law { kPosition, kVelocity, kComposite };
constexpr std::array<EnumName<Law>, 3> kLawNames{
    {{Law::kPosition, "position"}, {Law::kVelocity, "velocity"}, {Law::kComposite, "composite"}}};

struct FilterConfig {
  double low_hz{1.0};
  double high_hz{10.0};
  int order{2};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("low_hz", low_hz, Range{0, 1000}, "lower edge");
    v.field("high_hz", high_hz, Range{0, 1000}, "upper edge");
    v.field("order", order, Range{1, 8}, "of the filter");
  }
  void validate() const {
    if (low_hz >= high_hz) {
      throw InputError({.key = "high_hz", .problem = "is not above low_hz"});
    }
  }
};

struct Config {
  double loop_rate_hz{100.0};
  FilterConfig filter;
  Law law{Law::kComposite};
  bool enabled{true};
  std::string port{"/dev/ttyACM0"};
  Eigen::Vector3d offset_m{0.1, 0.2, 0.3};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("loop_rate_hz", loop_rate_hz, Range{10, 1000}, "cycles a second");
    v.section("filter", filter);  // before other keys, to see that the dump puts it after them
    v.choice("law", law, kLawNames, "control law");
    v.field("enabled", enabled, "use it");
    v.field("port", port, "serial device");
    v.field("offset_m", offset_m, Range{-5, 5}, "mounting");
  }
};

InputProblem problemOf(const std::string& text) {
  try {
    (void)parseConfig<Config>(text, "station.toml");
  } catch (const InputError& e) {
    EXPECT_EQ(e.problem().file, "station.toml");
    return e.problem();
  }
  ADD_FAILURE() << "accepted: " << text;
  return {};
}

TEST(Config, EmptyFileGivesTheDefaults) {
  const auto config = parseConfig<Config>("", "f");
  EXPECT_EQ(config.loop_rate_hz, 100.0);
  EXPECT_EQ(config.law, Law::kComposite);
  EXPECT_EQ(config.filter.order, 2);
}

TEST(Config, EveryKindOfFieldIsRead) {
  const auto config = parseConfig<Config>(
      "loop_rate_hz = 50\nlaw = 'velocity'\nenabled = false\nport = 'x'\noffset_m = [1, 2, "
      "3]\n[filter]\norder = 3\n",
      "f");
  EXPECT_EQ(config.loop_rate_hz, 50.0);
  EXPECT_EQ(config.law, Law::kVelocity);
  EXPECT_FALSE(config.enabled);
  EXPECT_EQ(config.port, "x");
  EXPECT_EQ(config.offset_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(config.filter.order, 3);
  EXPECT_EQ(config.filter.high_hz, 10.0);
}

TEST(Config, OutOfRangeNamesEverything) {
  try {
    (void)parseConfig<Config>("\nloop_rate_hz = 5\n", "station.toml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "station.toml:2: loop_rate_hz: is 5; allowed: a number, 10 to 1000");
  }
}

TEST(Config, UnknownKeyInASectionNamesTheNearest) {
  const InputProblem problem = problemOf("[filter]\norder = 2\nhihg_hz = 3\n");
  EXPECT_EQ(problem.key, "filter.hihg_hz");
  EXPECT_EQ(problem.line, 3);
  EXPECT_EQ(problem.remedy, "did you mean 'high_hz'?");
}

TEST(Config, UnknownSectionIsRefused) {
  EXPECT_EQ(problemOf("[fitler]\norder = 2\n").remedy, "did you mean 'filter'?");
}

TEST(Config, UnknownChoiceListsTheNames) {
  const InputProblem problem = problemOf("law = 'velcoity'\n");
  EXPECT_THAT(problem.problem, HasSubstr("velcoity"));
  EXPECT_EQ(problem.allowed, "position, velocity, composite");
  EXPECT_EQ(problemOf("law = 2\n").allowed, "position, velocity, composite");
}

TEST(Config, ValidateIsCalledAndGetsFileLineAndSection) {
  const InputProblem problem = problemOf("[filter]\nlow_hz = 20\nhigh_hz = 15\n");
  EXPECT_EQ(problem.key, "filter.high_hz");
  EXPECT_EQ(problem.line, 3);
  EXPECT_EQ(problem.problem, "is not above low_hz");
}

TEST(Config, SectionThatIsNoTableIsRefused) { EXPECT_EQ(problemOf("filter = 3\n").key, "filter"); }

TEST(Config, DumpDocumentsEveryKey) {
  const std::string text = dumpConfig(Config{});
  EXPECT_THAT(text, HasSubstr("loop_rate_hz = 100.0  # cycles a second; 10 to 1000\n"));
  EXPECT_THAT(text,
              HasSubstr("law = \"composite\"  # control law; position, velocity, composite\n"));
  EXPECT_THAT(text, HasSubstr("\n[filter]\nlow_hz = 1.0"));
}

std::uint64_t bits(double value) {
  std::uint64_t out = 0;
  std::memcpy(&out, &value, sizeof out);
  return out;
}

TEST(Config, DumpReadsBackBitForBit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> rate(10.0, 1000.0);
  std::uniform_real_distribution<double> offset(-5.0, 5.0);
  for (int i = 0; i < 500; ++i) {
    Config config;
    config.loop_rate_hz = rate(random);
    config.filter.low_hz = std::ldexp(rate(random), -1060);  // subnormal
    config.filter.order = 1 + i % 8;
    config.law = kLawNames[static_cast<std::size_t>(i) % 3].value;
    config.enabled = i % 2 == 0;
    config.port = std::string("a\"b\\c\n") + static_cast<char>(i % 26 + 'a');
    config.offset_m = {offset(random), offset(random), -0.0};
    const auto back = parseConfig<Config>(dumpConfig(config), "dump");
    EXPECT_EQ(bits(back.loop_rate_hz), bits(config.loop_rate_hz));
    EXPECT_EQ(bits(back.filter.low_hz), bits(config.filter.low_hz));
    EXPECT_EQ(back.filter.order, config.filter.order);
    EXPECT_EQ(back.law, config.law);
    EXPECT_EQ(back.enabled, config.enabled);
    EXPECT_EQ(back.port, config.port);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(bits(back.offset_m[k]), bits(config.offset_m[k]));
  }
}

TEST(RangeText, SaysOnlyWhatIsBounded) {
  EXPECT_EQ(rangeText({0.1, 5}), "0.1 to 5");
  EXPECT_EQ(rangeText({.min = 0}), "at least 0");
  EXPECT_EQ(rangeText({.max = 1}), "at most 1");
  EXPECT_EQ(rangeText({}), "any finite number");
}

struct Area {
  FixedList<Eigen::Vector2d, 4> corners_m;
  double height_m{1.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("corners_m", corners_m, Range{-10, 10}, "in order");
    v.field("height_m", height_m, Range{0, 10}, "above the floor");
  }
};
struct Areas {
  FixedList<Area, 2> areas;
  FilterConfig filter;
  template <class Visitor>
  void fields(Visitor& v) {
    v.rows("areas", areas, "to stay out of");
    v.section("filter", filter);
  }
};

TEST(ConfigFile, RowsComeBackAsTheyWent) {
  Areas areas;
  Area area;
  ASSERT_TRUE(area.corners_m.add({0.1, 0.2}) && area.corners_m.add({1.0 / 3.0, -5.0}));
  ASSERT_TRUE(areas.areas.add(area));
  area.height_m = 7.0;
  ASSERT_TRUE(areas.areas.add(area));
  const auto back = parseConfig<Areas>(dumpConfig(areas), "dump");
  ASSERT_EQ(back.areas.all().size(), 2U);
  EXPECT_EQ(back.areas.all()[1].height_m, 7.0);
  ASSERT_EQ(back.areas.all()[0].corners_m.all().size(), 2U);
  EXPECT_EQ(back.areas.all()[0].corners_m.all()[1], Eigen::Vector2d(1.0 / 3.0, -5.0));
  EXPECT_EQ(dumpConfig(back), dumpConfig(areas));
}

TEST(ConfigFile, MoreRowsOrPointsThanThereIsRoomForAreRefused) {
  const std::string row = "[[areas]]\nheight_m = 2\n";
  EXPECT_NO_THROW((void)parseConfig<Areas>(row + row, "rows"));
  EXPECT_THROW((void)parseConfig<Areas>(row + row + row, "rows"), InputError);
  EXPECT_THROW((void)parseConfig<Areas>(
                   "[[areas]]\ncorners_m = [[0, 0], [0, 1], [1, 1], [1, 0], [2, 2]]\n", "points"),
               InputError);
}

}  // namespace
}  // namespace tautline
