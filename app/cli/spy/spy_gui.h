#pragma once

/// @file
/// Debian's lcm-spy with the project's types. Its own start script passes an option that Java no
/// longer knows and ignores the class path, so the program in it is started directly.

#include <string>

namespace tautline::cli {

/// Becomes lcm-spy. @throws InputError that says what is missing, with the command that brings it.
[[noreturn]] void becomeLcmSpy(const std::string& lcm_url);

}  // namespace tautline::cli
