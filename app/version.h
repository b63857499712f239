#pragma once

namespace tautline {

/// Of all programs; the project's version in CMakeLists.txt.
inline constexpr const char* kVersion = TAUTLINE_VERSION;

}  // namespace tautline
