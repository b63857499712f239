#pragma once

/// @file
/// Who this user is to the station, the same in every run: a session number in a file that only
/// the user can read, and a name. Not real-time safe: for operator tools only.

#include <cstdint>
#include <string>

namespace tautline::cli {

class OperatorIdentity {
 public:
  /// Reads the file, or makes it: tautline-operator in $XDG_RUNTIME_DIR, or in /tmp with the user's
  /// number. The name is user@host; $TAUTLINE_OPERATOR replaces it, and is an operator of its own.
  /// @throws InputError if the file can neither be read nor made.
  OperatorIdentity();

  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Wall clock in microseconds, or one more than the last: grows in a run and from run to run.
  [[nodiscard]] std::int64_t nextSequence() noexcept;

 private:
  std::string name_;
  std::int64_t session_{0};
  std::int64_t last_{0};
};

}  // namespace tautline::cli
