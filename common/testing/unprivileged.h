#pragma once

/// @file
/// For tests of what is forbidden: root passes permissions, exclusive terminals and limits.

#include <unistd.h>

#include <gtest/gtest.h>

namespace tautline::testing {

/// While this lives, a process of root is nobody; another one stays who it is.
class Unprivileged {
 public:
  Unprivileged() : root_(geteuid() == 0) { set(65534); }
  ~Unprivileged() { set(0); }
  Unprivileged(const Unprivileged&) = delete;
  Unprivileged& operator=(const Unprivileged&) = delete;

 private:
  void set(uid_t user) const { EXPECT_TRUE(!root_ || seteuid(user) == 0); }
  bool root_;
};

}  // namespace tautline::testing
