#pragma once

/// @file
/// Text inside HTML and XML.

#include <string>

namespace tautline {

/// `text` as content or attribute of an element; control characters become blanks. Not real-time
/// safe.
[[nodiscard]] std::string escaped(const std::string& text);

}  // namespace tautline
