#include "common/realtime.h"

#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/testing/unprivileged.h"

namespace tautline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(RealTimeSteps, AMissingRightIsMendedByHandAndInAService) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_RTPRIO, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_RTPRIO, &none), 0);
  RealTimeStep step;
  {
    const testing::Unprivileged nobody;
    step = setFifoPriority(50);
  }
  ASSERT_EQ(setrlimit(RLIMIT_RTPRIO, &before), 0);
  EXPECT_FALSE(step.ok);
  EXPECT_THAT(step.reason, AllOf(HasSubstr("'@tautline - rtprio 98' in /etc/security/limits.d"),
                                 HasSubstr("LimitRTPRIO=98 in its unit")));
}

TEST(RealTimeSteps, AProcessorThatIsNotThereIsNamedWithItsKey) {
  const RealTimeStep step = setAffinity(1000);
  EXPECT_FALSE(step.ok);
  EXPECT_THAT(step.reason, HasSubstr("realtime_cpu"));
}

}  // namespace
}  // namespace tautline
