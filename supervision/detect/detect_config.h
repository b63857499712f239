#pragma once

/// @file
/// Settings of all detectors but the fence, which has its own section.

#include "supervision/detect/contact_watch.h"
#include "supervision/detect/host_watch.h"
#include "supervision/detect/link_watch.h"
#include "supervision/detect/oscillation_watch.h"
#include "supervision/detect/parked_check.h"
#include "supervision/detect/power_watch.h"
#include "supervision/detect/reel_scale_watch.h"
#include "supervision/detect/tether_watch.h"

namespace tautline {

struct DetectConfig {
  TetherWatchConfig tether;
  ContactWatchConfig contact;
  OscillationConfig oscillation;
  PowerConfig power;
  LinkWatchConfig link;
  HostWatchConfig host;
  ParkedCheckConfig parked;
  ReelScaleConfig reel_scale;
  bool vehicle_signs{true};  ///< Heed what the vehicle says of itself; false only on a bench.

  template <class Visitor>
  void fields(Visitor& v) {
    v.section("tether", tether);
    v.section("contact", contact);
    v.section("oscillation", oscillation);
    v.section("power", power);
    v.section("link", link);
    v.section("host", host);
    v.section("parked", parked);
    v.section("reel_scale", reel_scale);
    v.field("vehicle_signs", vehicle_signs,
            "heed the vehicle's own flags and flight modes; false, as published: only on a bench");
  }
};

}  // namespace tautline
