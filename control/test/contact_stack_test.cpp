#include "control/contact_stack.h"

#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tautline {
namespace {

using Change = ContactStack::Change;

MissionPlan planWith(const std::vector<Eigen::Vector3d>& contacts) {
  MissionPlan plan;
  for (const Eigen::Vector3d& p : contacts) {
    const int i = plan.contact_count++;
    plan.contacts[static_cast<std::size_t>(i)] = {.id = i + 1, .p_WC = p};
  }
  return plan;
}

Eigen::Vector3d vector(const nlohmann::json& j) {
  return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()};
}

TEST(ContactStack, GivesTheEffectiveControlsOfTheReference) {
  const std::string path =
      std::string(TAUTLINE_SOURCE_DIR) + "/control/test/golden/effective_controls.json";
  std::ifstream file(path);
  ASSERT_TRUE(file) << path;
  const nlohmann::json golden = nlohmann::json::parse(file);
  ASSERT_GT(golden["cases"].size(), 10U);
  for (const auto& want : golden["cases"]) {
    std::vector<Eigen::Vector3d> contacts;
    for (std::size_t i = 1; i < want["stack"].size(); ++i)
      contacts.push_back(vector(want["stack"][i]));
    const MissionPlan plan = planWith(contacts);
    ContactStack stack;
    for (int id = 1; id <= plan.contact_count; ++id)
      ASSERT_EQ(stack.select(id, plan), Change::kPushed);

    const EffectiveControls got = stack.effective(vector(want["x"]));
    EXPECT_NEAR(got.L_static, want["L_sta"].get<double>(), 1e-12);
    EXPECT_NEAR(got.q.L, want["L_eff"].get<double>(), 1e-12);
    EXPECT_NEAR(got.q.theta, want["theta"].get<double>(), 1e-12);
    EXPECT_NEAR(got.q.phi, want["phi"].get<double>(), 1e-12);
    EXPECT_NEAR(got.L_total, want["L"].get<double>(), 1e-12);
    EXPECT_EQ(stack.anchor().contact_count, plan.contact_count);
    EXPECT_EQ(stack.anchor().p_WA, contacts.empty() ? Eigen::Vector3d::Zero() : contacts.back());
  }
}

TEST(ContactStack, PushesNewContactsAndPopsDownToKnownOnes) {
  const MissionPlan plan = planWith({{3, 0, 0}, {3, 4, 0}, {3, 4, 12}});
  ContactStack stack;
  EXPECT_EQ(stack.activeId(), kReelContact);
  EXPECT_EQ(stack.select(0, plan), Change::kNone);
  EXPECT_EQ(stack.select(1, plan), Change::kPushed);
  EXPECT_EQ(stack.select(1, plan), Change::kNone);
  EXPECT_EQ(stack.select(2, plan), Change::kPushed);
  EXPECT_EQ(stack.select(3, plan), Change::kPushed);
  EXPECT_DOUBLE_EQ(stack.anchor().L_static, 3.0 + 4.0 + 12.0);
  EXPECT_EQ(stack.select(1, plan), Change::kPopped);  // two at once
  EXPECT_DOUBLE_EQ(stack.anchor().L_static, 3.0);
  EXPECT_EQ(stack.contactCount(), 1);
  EXPECT_EQ(stack.select(3, plan), Change::kPushed);  // straight from 1 to 3
  EXPECT_DOUBLE_EQ(stack.anchor().L_static, 3.0 + std::hypot(4.0, 12.0));
  EXPECT_EQ(stack.point(1), Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(stack.select(0, plan), Change::kPopped);
  EXPECT_EQ(stack.anchor().L_static, 0.0);
  EXPECT_EQ(stack.anchor().contact_count, 0);
}

TEST(ContactStack, KeepsWhatItHasWhenAContactCannotBeSelected) {
  MissionPlan plan = planWith({{1, 0, 0}, {2, 0, 0}});
  plan.contacts[1].p_WC.y() = std::numeric_limits<double>::quiet_NaN();
  ContactStack stack;
  ASSERT_EQ(stack.select(1, plan), Change::kPushed);
  EXPECT_EQ(stack.select(7, plan), Change::kUnknownId);
  EXPECT_EQ(stack.select(2, plan), Change::kBadPoint);
  EXPECT_EQ(stack.activeId(), 1);
  stack.clear();
  EXPECT_EQ(stack.activeId(), kReelContact);
}

TEST(ContactStack, HoldsAsManyContactsAsAPlanCanHaveAndNoMore) {
  std::vector<Eigen::Vector3d> line;
  for (int i = 1; i <= kMaxContacts; ++i) line.emplace_back(i, 0, 0);
  const MissionPlan plan = planWith(line);
  ContactStack stack;
  for (int id = 1; id <= kMaxContacts; ++id) ASSERT_EQ(stack.select(id, plan), Change::kPushed);
  EXPECT_DOUBLE_EQ(stack.anchor().L_static, kMaxContacts);
  MissionPlan other;
  other.contact_count = 1;
  other.contacts[0] = {.id = 1000, .p_WC = {0, 1, 0}};
  EXPECT_EQ(stack.select(1000, other), Change::kFull);
  EXPECT_EQ(stack.activeId(), kMaxContacts);
}

}  // namespace
}  // namespace tautline
