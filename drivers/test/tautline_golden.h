#pragma once

/// @file
/// Messages of the Tautline bus as candump writes them and as they stand on a serial line, made by
/// hand-placed bits and bit-by-bit CRCs that share nothing with the codec.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/bus_frame.h"

namespace tautline::testing {

struct GoldenFrame {
  const char* candump;  ///< "ID#DATA", hexadecimal.
  const char* serial;   ///< The same as a COBS frame with its zero byte, hexadecimal.
};

inline constexpr GoldenFrame kReelGolden{"100#40E201FA803431CD", "010D010840E201FA803431CD25DA00"};
inline constexpr GoldenFrame kReelLimitsGolden{"100#FFFFFF00E0FFFF25",
                                               "01060108FFFFFF07E0FFFF2585CB00"};
inline constexpr GoldenFrame kAnglesGolden{"110#7414A4C20000009C",
                                           "081001087414A4C20101049CD35C00"};
inline constexpr GoldenFrame kAnglesFaultGolden{"110#A4C2B77A02009049",
                                                "09100108A4C2B77A02059049511C00"};
inline constexpr GoldenFrame kAttitudeLevelGolden{"120#FF0F000000007076",
                                                  "06200108FF0F010101057076613000"};
inline constexpr GoldenFrame kAttitudeYawGolden{"120#500B00402D0080BF",
                                                "06200108500B03402D0580BF88EA00"};
inline constexpr GoldenFrame kVehicleGolden{"121#5200537701FF1737",
                                            "052101085209537701FF1737E50500"};
inline constexpr GoldenFrame kRatesGolden{"200#2C017D3078E8435B", "010D02082C017D3078E8435BD28B00"};
inline constexpr GoldenFrame kTakeoffGolden{"210#12B80B18FCC0BB", "0D10020712B80B18FCC0BBEA3100"};
inline constexpr GoldenFrame kDisarmedGolden{"210#000000000000CA", "04100207010101010104CAD60C00"};
inline constexpr std::array kGoldenFrames{
    kReelGolden,        kReelLimitsGolden, kAnglesGolden, kAnglesFaultGolden, kAttitudeLevelGolden,
    kAttitudeYawGolden, kVehicleGolden,    kRatesGolden,  kTakeoffGolden,     kDisarmedGolden};

inline std::vector<std::uint8_t> bytesOfHex(std::string_view hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(
        static_cast<std::uint8_t>(std::stoul(std::string(hex.substr(i, 2)), nullptr, 16)));
  return bytes;
}

/// A frame from "ID#DATA".
inline BusFrame frameOf(std::string_view candump) {
  BusFrame frame;
  const std::size_t mark = candump.find('#');
  frame.id =
      static_cast<std::uint16_t>(std::stoul(std::string(candump.substr(0, mark)), nullptr, 16));
  for (const std::uint8_t byte : bytesOfHex(candump.substr(mark + 1)))
    frame.data[frame.size++] = byte;
  return frame;
}

}  // namespace tautline::testing
