#pragma once

/// @file
/// Whether this machine can send to the multicast group of an LCM URL. LCM itself answers a missing
/// route with a page of text on stderr; asking first lets a program say it in one line.

#include <string>

namespace tautline {

/// True unless `lcm_url` is of the form udpm://ADDRESS:PORT… and the kernel knows no way to
/// ADDRESS. Not real-time safe: start-up only.
[[nodiscard]] bool hasMulticastRoute(const std::string& lcm_url);

}  // namespace tautline
