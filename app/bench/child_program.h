#pragma once

/// @file
/// Another program of the project as a process: it runs as long as its object lives, and no longer
/// than this process. Not real-time safe.

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "common/time.h"

namespace tautline::bench {

/// Beside this process's own program. Throws InputError if there is none.
[[nodiscard]] std::filesystem::path programBeside(const std::string& name);

class ChildProgram {
 public:
  /// Starts it in a process group of its own, so that a terminal's Ctrl-C is not for it. What it
  /// says goes to the file `folder`/NAME.txt; `folder` is its XDG_RUNTIME_DIR. Throws
  /// std::system_error if there can be no process.
  ChildProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder);
  /// Asks it to end; kills it after two seconds.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Empty while it runs; else how it ended, and its last line.
  [[nodiscard]] std::string ended();

  /// Asks it to end, as the destructor; empty if it did so with exit code 0, else as ended().
  [[nodiscard]] std::string end();

  /// The last line that it said.
  [[nodiscard]] std::string lastLine() const;

  /// It stands still for so long, as if the machine gave it no processor.
  void standStill(Duration duration) noexcept;

 private:
  void send(int signal) noexcept;
  [[nodiscard]] bool reap(int options) noexcept;
  [[nodiscard]] std::string outcome() const;

  std::string name_;
  std::filesystem::path output_;
  pid_t process_{-1};
  bool running_{true};
  int status_{0};  ///< As waitpid() has it, once it runs no more.
};

}  // namespace tautline::bench
