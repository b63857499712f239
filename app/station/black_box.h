#pragma once

/// @file
/// The last minutes of the loop, cycle by cycle, in a file that outlives the process: a ring of
/// fixed-size records in a memory-mapped file (by default in /dev/shm, so that writing it never
/// waits for a disk). Whatever ends the station, the records up to the last finished cycle are
/// there; `tautline blackbox FILE` prints them as CSV.

#include <cstdint>
#include <filesystem>
#include <ostream>

#include "app/station/station.h"

namespace tautline {

/// One cycle as it is stored: fixed layout, native byte order, SI units.
struct CycleRecord {
  std::int64_t now_ns{0};
  std::int64_t lateness_ns{0};
  std::int64_t work_ns{0};
  std::uint64_t conditions{0};
  std::uint8_t mode{0};
  std::uint8_t action{0};
  std::uint8_t health{0};
  std::uint8_t engaged{0};
  double length_meas{0.0};
  double theta_meas{0.0};
  double phi_meas{0.0};
  double p_WD[3]{};
  double T{0.0};
  double length_rate{0.0};
  double elevation_rate{0.0};
  double azimuth_rate{0.0};
  std::int32_t waypoint{-1};
  std::uint32_t padding{0};
};

/// What to store of a cycle. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] CycleRecord makeRecord(const StepInput& in, const StepOutput& out, Duration lateness,
                                     Duration work) noexcept;

class BlackBox {
 public:
  static constexpr std::uint32_t kCapacity = 16384;  ///< Nearly three minutes at 100 Hz.

  /// Makes the file, or starts it anew. The previous run's file is kept beside it with the suffix
  /// ".previous".
  /// @throws InputError if it cannot be made, or another station uses it. Not real-time safe:
  /// start-up only.
  explicit BlackBox(const std::filesystem::path& path);
  ~BlackBox();
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  /// Real-time safe: no allocation, no locks, no exceptions.
  void record(const CycleRecord& cycle) noexcept;

  /// Writes a black box file as CSV, oldest cycle first; returns the number of cycles. @throws
  /// InputError for a file that is none. Not real-time safe.
  static std::uint32_t print(const std::filesystem::path& path, std::ostream& out);

 private:
  struct Header;
  int fd_{-1};               ///< Holds the lock that keeps a second station away.
  Header* header_{nullptr};  ///< Start of the mapped file; the records follow it.
  CycleRecord* records_{nullptr};
};

}  // namespace tautline
