#include "app/cli/flight/stick_script.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"

namespace tautline::cli::flight {
namespace {

using std::chrono::milliseconds;

std::string fileWith(const std::string& text) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "tautline_sticks.txt";
  std::ofstream(path) << text;
  return path.string();
}

TEST(StickScript, RowsLastAsLongAsTheySay) {
  const auto rows =
      readStickScript(fileWith("# up\n0.5 1 0 0.1 0 0 0\n\n1 0 0 0 0 0 0 # hands off\n"));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rowAt(rows, milliseconds(499))->rates.elevation, 0.1);
  EXPECT_TRUE(rowAt(rows, milliseconds(499))->dead_man);
  EXPECT_FALSE(rowAt(rows, milliseconds(500))->dead_man);
  EXPECT_FALSE(rowAt(rows, milliseconds(1500)));
}

TEST(StickScript, BadRowsAreNamedByLine) {
  for (const char* row :
       {"1 1 0 0 0 0", "1 2 0 0 0 0 0", "-1 1 0 0 0 0 0", "one 1 0 0 0 0 0", "1 1 0 0 0 0 0 0"}) {
    try {
      static_cast<void>(readStickScript(fileWith(std::string("1 1 0 0 0 0 0\n") + row + "\n")));
      ADD_FAILURE() << row;
    } catch (const InputError& e) {
      EXPECT_EQ(e.problem().line, 2) << row;
    }
  }
}

TEST(StickScript, AMissingFileIsNamed) {
  EXPECT_THROW(static_cast<void>(readStickScript("/nowhere/sticks.txt")), InputError);
}

}  // namespace
}  // namespace tautline::cli::flight
