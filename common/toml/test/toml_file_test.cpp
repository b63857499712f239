#include "common/toml/toml_file.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/toml/toml_writer.h"

namespace tautline {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The error that `action` throws; a test failure if it throws none.
template <class Action>
InputProblem problemOf(Action action) {
  try {
    action();
  } catch (const InputError& e) {
    EXPECT_EQ(e.code(), ExitCode::kConfig);
    return e.problem();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

TEST(TomlFile, MissingFileAndFolderAreNamed) {
  EXPECT_EQ(problemOf([] { (void)TomlFile::load("/nowhere/x.toml"); }).file, "/nowhere/x.toml");
  EXPECT_THAT(problemOf([] { (void)TomlFile::load("/nowhere/x.toml"); }).problem,
              HasSubstr("No such file"));
  EXPECT_THAT(problemOf([] { (void)TomlFile::load("/tmp"); }).problem, HasSubstr("folder"));
}

TEST(TomlFile, SyntaxErrorHasItsLine) {
  const InputProblem problem =
      problemOf([] { (void)TomlFile::parse("a = 1\nb = = 2\n", "bad.toml"); });
  EXPECT_EQ(problem.file, "bad.toml");
  EXPECT_EQ(problem.line, 2);
  EXPECT_THAT(problem.problem, StartsWith("not valid TOML"));
}

TEST(TomlFile, KeyGivenTwiceIsAnError) {
  EXPECT_EQ(problemOf([] { (void)TomlFile::parse("a = 1\na = 2\n", "twice.toml"); }).line, 2);
}

TEST(TomlFile, LineOfKeysRowsAndTheirParents) {
  const TomlFile file = TomlFile::parse(
      "a = 1\n\n[b]\nc = 2\n\n[[rows]]\nx = 1\n[[rows]]\nx = 2\n\n[d]\ninline = [\n {y = 1},\n {y "
      "= 2}]\n",
      "f");
  EXPECT_EQ(file.lineOf("a"), 1);
  EXPECT_EQ(file.lineOf("b.c"), 4);
  EXPECT_EQ(file.lineOf("b.missing"), 3);
  EXPECT_EQ(file.lineOf("rows[0].x"), 7);
  EXPECT_EQ(file.lineOf("rows[1].x"), 9);
  EXPECT_EQ(file.lineOf("d.inline[1].y"), 14);
  EXPECT_EQ(file.lineOf("nothing"), 0);
  EXPECT_EQ(file.lineOf(""), 0);
}

TEST(TomlTable, OptionalKeyKeepsTheDefault) {
  TomlTable root = TomlFile::parse("", "f").root();
  double value = 7.5;
  EXPECT_FALSE(root.read("absent", value));
  EXPECT_EQ(value, 7.5);
}

TEST(TomlTable, RequiredKeyIsRequired) {
  TomlTable root = TomlFile::parse("[[rows]]\na = 1\n[[rows]]\nb = 2\n", "f").root();
  const InputProblem problem = problemOf([&] {
    for (TomlTable& row : root.tables("rows")) {
      double a = 0.0;
      row.require("a", a);
    }
  });
  EXPECT_EQ(problem.key, "rows[1].a");
  EXPECT_EQ(problem.line, 3);
  EXPECT_EQ(problem.problem, "missing");
}

TEST(TomlTable, IntegerIsANumberButARealIsNoInteger) {
  TomlTable root = TomlFile::parse("a = 3\nb = 3.0\n", "f").root();
  double real = 0.0;
  int integer = 0;
  EXPECT_TRUE(root.read("a", real));
  EXPECT_EQ(real, 3.0);
  EXPECT_EQ(problemOf([&] { root.read("b", integer); }).line, 2);
}

TEST(TomlTable, NumbersAreFiniteAndInRange) {
  for (const char* text : {"a = nan", "a = inf", "a = -inf", "a = 5.0001", "a = -1e-9", "a = \"1\"",
                           "a = true", "a = [1]", "a = 1979-05-27"}) {
    TomlTable root = TomlFile::parse(text, "f").root();
    double value = 1.0;
    EXPECT_THAT(problemOf([&] {
                  root.read("a", value, Range{0, 5});
                }).allowed,
                HasSubstr("0 to 5"))
        << text;
    EXPECT_EQ(value, 1.0) << text;
  }
  for (const char* text : {"a = nan", "a = inf"}) {
    TomlTable root = TomlFile::parse(text, "f").root();
    double value = 1.0;
    EXPECT_THROW(root.read("a", value), InputError) << text;
  }
}

TEST(TomlTable, IntegersThatDoNotFitAreRefused) {
  for (const char* text : {"a = 2147483648", "a = -2147483649", "a = 9223372036854775807"}) {
    TomlTable root = TomlFile::parse(text, "f").root();
    int value = 1;
    EXPECT_THROW(root.read("a", value), InputError) << text;
  }
}

TEST(TomlTable, VectorsHaveThreeNumbersInRange) {
  TomlTable good = TomlFile::parse("a = [1, 2.5, -3]", "f").root();
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  EXPECT_TRUE(good.read("a", value));
  EXPECT_EQ(value, Eigen::Vector3d(1, 2.5, -3));
  for (const char* text : {"a = [1, 2]", "a = [1, 2, 3, 4]", "a = [1, 2, nan]", "a = [1, 2, \"3\"]",
                           "a = 1", "a = [1, 2, 99]"}) {
    TomlTable root = TomlFile::parse(text, "f").root();
    EXPECT_THROW(root.read("a", value, Range{-9, 9}), InputError) << text;
    EXPECT_EQ(value, Eigen::Vector3d(1, 2.5, -3)) << text;
  }
}

TEST(TomlTable, PairsAndTheirRows) {
  TomlTable root = TomlFile::parse("good = [[0, 1], [2.5, 3]]\nbad = [[0, 1], [2]]\n", "f").root();
  std::vector<Eigen::Vector2d> pairs;
  EXPECT_TRUE(root.read("good", pairs));
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[1], Eigen::Vector2d(2.5, 3));
  EXPECT_EQ(problemOf([&] { root.read("bad", pairs); }).key, "bad[1]");
}

TEST(TomlTable, ListsOfNumbersOfAnyLength) {
  TomlTable root = TomlFile::parse("a = [0.5, 1, 0]\nempty = []\n", "f").root();
  std::vector<double> list{7.0};
  EXPECT_FALSE(root.read("absent", list));
  EXPECT_EQ(list, std::vector<double>{7.0});
  EXPECT_TRUE(root.read("a", list, Range{0, 1}));
  EXPECT_EQ(list, (std::vector<double>{0.5, 1.0, 0.0}));
  EXPECT_TRUE(root.read("empty", list));
  EXPECT_TRUE(list.empty());
}

TEST(TomlTable, ListsOfListsNeedNotBeRectangular) {
  TomlTable root = TomlFile::parse("a = [[0, 1], [2.5], [], [3, 4, 5]]\n", "f").root();
  std::vector<std::vector<double>> rows;
  EXPECT_TRUE(root.read("a", rows));
  EXPECT_EQ(rows, (std::vector<std::vector<double>>{{0, 1}, {2.5}, {}, {3, 4, 5}}));
}

TEST(TomlTable, WrongEntriesOfListsAreNamedWithTheirLine) {
  struct Case {
    const char* text;
    const char* key;
    int line;
  };
  for (const Case& c :
       {Case{"a = [0,\n nan]", "a[1]", 2}, Case{"a = [0, 1.5]", "a[1]", 1},
        Case{"a = [\"0\"]", "a[0]", 1}, Case{"a = 1", "a", 1}, Case{"a = [[0]]", "a[0]", 1}}) {
    TomlTable root = TomlFile::parse(c.text, "f").root();
    std::vector<double> list{7.0};
    const InputProblem problem = problemOf([&] { root.read("a", list, Range{0, 1}); });
    EXPECT_EQ(problem.key, c.key) << c.text;
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_THAT(problem.allowed, HasSubstr("0 to 1")) << c.text;
    EXPECT_EQ(list, std::vector<double>{7.0}) << c.text;
  }
  for (const Case& c :
       {Case{"a = [[0],\n [1,\n -1]]", "a[1][1]", 3}, Case{"a = [[0],\n true]", "a[1]", 2},
        Case{"a = [[0], [1, inf]]", "a[1][1]", 1}, Case{"a = {b = 1}", "a", 1}}) {
    TomlTable root = TomlFile::parse(c.text, "f").root();
    std::vector<std::vector<double>> rows{{7.0}};
    const InputProblem problem = problemOf([&] { root.read("a", rows, Range{0, 1}); });
    EXPECT_EQ(problem.key, c.key) << c.text;
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_THAT(problem.allowed, HasSubstr("0 to 1")) << c.text;
    EXPECT_EQ(rows, (std::vector<std::vector<double>>{{7.0}})) << c.text;
  }
}

TEST(TomlTable, TablesAreListedAndKeysFound) {
  TomlTable root = TomlFile::parse("z = 1\n[b]\nx = 1\n[a]\n[[rows]]\n", "f").root();
  EXPECT_EQ(root.tableNames(), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(root.has("z"));
  EXPECT_TRUE(root.has("rows"));
  EXPECT_FALSE(root.has("x"));
  EXPECT_TRUE(root.table("b").front().has("x"));
}

TEST(TomlTable, ErrorsShowTheValueOnOneLine) {
  TomlTable root = TomlFile::parse("a = [0.01,\n [1, \"x\"], {b = true, c = [0.5]}]\n", "f").root();
  double value = 0.0;
  EXPECT_EQ(problemOf([&] { root.read("a", value); }).problem,
            "is [0.01, [1, 'x'], {b = true, c = [0.5]}], not a number");
}

TEST(TomlTable, UnknownKeyIsRefusedWithTheNearestOne) {
  TomlTable root = TomlFile::parse("[[rows]]\npositoin_m = 1\n", "f.toml").root();
  const InputProblem problem = problemOf([&] {
    TomlTable row = root.tables("rows").front();
    double value = 0.0;
    row.read("position_m", value);
    row.read("speed_mps", value);
    row.finish();
  });
  EXPECT_EQ(problem.key, "rows[0].positoin_m");
  EXPECT_EQ(problem.line, 2);
  EXPECT_EQ(problem.remedy, "did you mean 'position_m'?");
  EXPECT_EQ(problem.allowed, "position_m, speed_mps");
}

TEST(TomlTable, FirstUnknownKeyOfTheFileIsReported) {
  TomlTable root = TomlFile::parse("z = 1\na = 2\n", "f").root();
  EXPECT_EQ(problemOf([&] { root.finish(); }).key, "z");
}

TEST(TomlTable, TableAndListAreNotConfused) {
  TomlTable root = TomlFile::parse("list = [1]\nnumber = 3\n[table]\n", "f").root();
  EXPECT_EQ(problemOf([&] { (void)root.tables("list"); }).key, "list[0]");
  EXPECT_EQ(problemOf([&] { (void)root.tables("table"); }).key, "table");
  EXPECT_EQ(problemOf([&] { (void)root.table("number"); }).line, 2);
  EXPECT_TRUE(root.tables("absent").empty());
  EXPECT_TRUE(root.table("absent").empty());
}

TEST(TomlText, RealNumbersReadBackBitForBit) {
  for (const double value :
       {0.1, 1.0 / 3.0, 1e300, 5e-324, -0.0, 123456789.125, 1e22, 4.0, 2.2250738585072014e-308}) {
    TomlTable root = TomlFile::parse("a = " + tomlText(value), "f").root();
    double back = 99.0;
    ASSERT_TRUE(root.read("a", back)) << value;
    EXPECT_EQ(std::signbit(back), std::signbit(value));
    EXPECT_EQ(back, value);
  }
}

TEST(TomlText, AnyTextReadsBack) {
  const std::string text = "tab\t quote\" backslash\\ line\n bell\a é";
  TomlTable root = TomlFile::parse("a = " + tomlText(text), "f").root();
  std::string back;
  root.require("a", back);
  EXPECT_EQ(back, text);
}

TEST(WriteFileAtomically, ReplacesTheWholeFileAndLeavesNothingElse) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "tautline_atomic";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  writeFileAtomically(folder / "a", "a long first text");
  writeFileAtomically(folder / "a", "short");
  EXPECT_EQ(readTextFile(folder / "a"), "short");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(WriteFileAtomically, FailureNamesTheFileAndLeavesNothing) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "tautline_no_such_folder";
  std::filesystem::remove_all(folder);
  const InputProblem problem = problemOf([&] { writeFileAtomically(folder / "a", "text"); });
  EXPECT_THAT(problem.file, EndsWith("tautline_no_such_folder/a"));
  EXPECT_THAT(problem.problem, AllOf(StartsWith("cannot be written"), HasSubstr("No such file")));

  // The target cannot be replaced by a file: the temporary file must be gone again.
  const std::filesystem::path busy = std::filesystem::path(::testing::TempDir()) / "tautline_busy";
  std::filesystem::create_directories(busy / "target");
  EXPECT_THROW(writeFileAtomically(busy / "target", "text"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(busy), {}), 1);
}

}  // namespace
}  // namespace tautline
