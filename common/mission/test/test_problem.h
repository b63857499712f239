#pragma once

/// @file
/// Catching the one error of load time in a test.

#include <string>

#include <gtest/gtest.h>

#include "common/error.h"

namespace tautline {

/// The problem that `action` throws; a test failure if it throws none.
template <class Action>
InputProblem problemOf(Action action, const std::string& about = {}) {
  try {
    action();
  } catch (const InputError& e) {
    return e.problem();
  }
  ADD_FAILURE() << "accepted: " << about;
  return {};
}

}  // namespace tautline
