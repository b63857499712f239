#include "app/station/station_config.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "app/station/station_device.h"
#include "common/error.h"
#include "common/toml/config_file.h"

namespace tautline {
namespace {

StationConfig parse(const std::string& text) { return parseConfig<StationConfig>(text, "test"); }

TEST(StationConfig, EveryExampleIsRight) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(TAUTLINE_SOURCE_DIR) + "/config")) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("station") || !name.ends_with(".toml")) continue;
    EXPECT_NO_THROW(static_cast<void>(loadConfig<StationConfig>(entry.path()))) << name;
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST(StationConfig, ChoosesTheDeviceAndWhereItIs) {
  for (const auto& kind : kDeviceKindNames) {
    StationConfig config =
        parse("run_mode = \"SIM\"\ndevice = \"" + std::string(kind.name) + "\"\n");
    EXPECT_EQ(config.device, kind.value);
    placeOf(config) = "somewhere";
    EXPECT_EQ(config.can.interface == "somewhere", kind.value == DeviceKind::kTautlineCan);
    EXPECT_EQ(config.replay.file == "somewhere", kind.value == DeviceKind::kReplay);
  }
}

TEST(StationConfig, RefusesWhatMakesNoSense) {
  EXPECT_THROW(parse("device = \"tautline\"\n"), InputError);
  EXPECT_THROW(parse("[can]\nbitrate = 500000\n"), InputError);
  EXPECT_THROW(parse("[replay]\nspeed = 0.0\n"), InputError);
  EXPECT_THROW(parse("device = \"replay\"\nrun_mode = \"REAL\"\n"), InputError);
  const std::string deaf = "[core.detect]\nvehicle_signs = false\n";
  EXPECT_THROW(parse("run_mode = \"REAL\"\n" + deaf), InputError);
  EXPECT_FALSE(parse("run_mode = \"HIL\"\n" + deaf).core.detect.vehicle_signs);
}

TEST(StationDevice, MakesEachKindAndSaysWhyItIsNotOpen) {
  StationConfig config;
  config.run_mode = RunMode::kHil;
  for (const auto kind :
       {DeviceKind::kFotokite, DeviceKind::kTautlineSerial, DeviceKind::kTautlineCan}) {
    config.device = kind;
    placeOf(config) = "tautline_no0";
    const StationDevice made = makeDevice(config);
    EXPECT_STREQ(made.device->name(), nameOf(kind, kDeviceKindNames));
    EXPECT_NE(made.warning.find("tautline_no0"), std::string::npos) << made.warning;
    EXPECT_FALSE(made.device->status().connected);
  }
  config.device = DeviceKind::kReplay;
  config.replay.file = "/no/such/file";
  EXPECT_THROW(static_cast<void>(makeDevice(config)), InputError);
}

}  // namespace
}  // namespace tautline
