#include "app/station/emulated_machine.h"

#include <gtest/gtest.h>

namespace tautline {
namespace {

TEST(EmulatedMachineTest, OnlyTheWholeWordCounts) {
  EXPECT_TRUE(hasEmulatedUart("tautline.emulated_uart"));
  EXPECT_TRUE(hasEmulatedUart("console=ttyS0  tautline.emulated_uart quiet\n"));
  EXPECT_FALSE(hasEmulatedUart(""));
  EXPECT_FALSE(hasEmulatedUart(" \n"));
  EXPECT_FALSE(hasEmulatedUart("console=ttyAMA0 root=/dev/mmcblk0p2 rw"));
  EXPECT_FALSE(hasEmulatedUart("tautline.emulated_uart2 xtautline.emulated_uart"));
  EXPECT_FALSE(hasEmulatedUart("tautline.emulated_uart=0"));
}

TEST(EmulatedMachineTest, TheMachineThatRunsTheTestsIsNone) {
  EXPECT_FALSE(thisMachineHasEmulatedUart());
}

}  // namespace
}  // namespace tautline
