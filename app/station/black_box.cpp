#include "app/station/black_box.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <memory>
#include <type_traits>

#include "common/error.h"

namespace tautline {

static_assert(std::is_trivially_copyable_v<CycleRecord>);

struct BlackBox::Header {
  static constexpr char kMagic[8] = {'T', 'A', 'U', 'T', 'B', 'B', '0', '1'};
  char magic[8];
  std::uint32_t record_size;
  std::uint32_t capacity;
  std::uint64_t count;  ///< Records ever written; the newest is at (count - 1) % capacity.
};

namespace {
constexpr std::size_t kRecordsSize = sizeof(CycleRecord) * BlackBox::kCapacity;
}  // namespace

CycleRecord makeRecord(const StepInput& in, const StepOutput& out, Duration lateness,
                       Duration work) noexcept {
  CycleRecord r;
  r.now_ns = in.now.time_since_epoch().count();
  r.lateness_ns = lateness.count();
  r.work_ns = work.count();
  r.conditions = out.conditions.bits();
  r.mode = static_cast<std::uint8_t>(out.supervision.mode);
  r.action = static_cast<std::uint8_t>(out.command.action);
  r.health = static_cast<std::uint8_t>(out.estimate.health);
  r.engaged = out.command.engaged ? 1 : 0;
  r.length_meas = in.sensors.reel.value.length;
  r.theta_meas = in.sensors.angles.value.theta;
  r.phi_meas = in.sensors.angles.value.phi;
  for (int i = 0; i < 3; ++i) r.p_WD[i] = out.estimate.p_WD[i];
  r.T = out.estimate.T;
  r.length_rate = out.command.length_rate;
  r.elevation_rate = out.command.elevation_rate;
  r.azimuth_rate = out.command.azimuth_rate;
  r.waypoint = out.mission.waypoint;
  return r;
}

BlackBox::BlackBox(const std::filesystem::path& path) {
  if (const int running = ::open(path.c_str(), O_RDONLY | O_CLOEXEC); running >= 0) {
    const bool in_use = ::flock(running, LOCK_EX | LOCK_NB) != 0;
    ::close(running);
    if (in_use) {
      throw InputError({.file = path.string(),
                        .problem = "is in use by another tautline-station",
                        .remedy = "stop that one first, or give this one a black_box of its own"},
                       ExitCode::kRefused);
    }
  }
  std::error_code ignored;
  std::filesystem::rename(path, path.string() + ".previous", ignored);  // there may be none
  constexpr std::size_t kFileSize = sizeof(Header) + kRecordsSize;
  // Space is reserved now: a full file system must not show itself in the loop. The lock lasts as
  // long as the descriptor.
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  int error = 0;
  if (fd < 0 || ::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    error = errno;
  } else {
    error = ::posix_fallocate(fd, 0, kFileSize);  // returns its error
  }
  if (error != 0) {
    if (fd >= 0) ::close(fd);
    throw InputError(
        {.file = path.string(),
         .problem = std::string("cannot make the black box: ") + std::strerror(error),
         .remedy = "set black_box to a file that can be written, or to \"\" for none"});
  }
  void* memory =
      ::mmap(nullptr, kFileSize, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
  if (memory == MAP_FAILED) {
    error = errno;
    ::close(fd);
    throw InputError({.file = path.string(),
                      .problem = std::string("cannot map the black box: ") + std::strerror(error)});
  }
  fd_ = fd;
  header_ = static_cast<Header*>(memory);
  records_ = reinterpret_cast<CycleRecord*>(header_ + 1);
  std::memcpy(header_->magic, Header::kMagic, sizeof(Header::kMagic));
  header_->record_size = sizeof(CycleRecord);
  header_->capacity = kCapacity;
  header_->count = 0;
}

BlackBox::~BlackBox() {
  ::munmap(header_, sizeof(Header) + kRecordsSize);
  ::close(fd_);
}

void BlackBox::record(const CycleRecord& cycle) noexcept {
  records_[header_->count % kCapacity] = cycle;
  // Last, and not before the record, so that a reader never counts a record that is not written.
  std::atomic_ref(header_->count).store(header_->count + 1, std::memory_order_release);
}

std::uint32_t BlackBox::print(const std::filesystem::path& path, std::ostream& out) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError({.file = path.string(),
                      .problem = "cannot be read",
                      .remedy = "give the file named by black_box in the station's config"});
  Header header{};
  in.read(reinterpret_cast<char*>(&header), sizeof(header));
  if (!in || std::memcmp(header.magic, Header::kMagic, sizeof(Header::kMagic)) != 0 ||
      header.record_size != sizeof(CycleRecord) || header.capacity != kCapacity) {
    throw InputError({.file = path.string(),
                      .problem = "is not a black box of this version of tautline-station"});
  }
  const auto records = std::make_unique<CycleRecord[]>(header.capacity);
  in.read(reinterpret_cast<char*>(records.get()), kRecordsSize);
  if (!in) throw InputError({.file = path.string(), .problem = "is cut short"});
  const auto stored =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(header.count, header.capacity));
  out << std::setprecision(12)
      << "now_s,lateness_us,work_us,mode,conditions,health,waypoint,length_meas_m,elevation_meas_"
         "rad,azimuth_meas_rad,"
         "x_m,y_m,z_m,tension_n,engaged,action,length_rate_mps,elevation_rate_radps,azimuth_rate_"
         "radps\n";
  for (std::uint64_t i = header.count - stored; i < header.count; ++i) {
    const CycleRecord& r = records[i % header.capacity];
    out << static_cast<double>(r.now_ns) * 1e-9 << ',' << static_cast<double>(r.lateness_ns) * 1e-3
        << ',' << static_cast<double>(r.work_ns) * 1e-3 << ','
        << nameOf(static_cast<Mode>(r.mode), kModeNames) << ','
        << describe(ConditionSet::fromBits(r.conditions)) << ','
        << nameOf(static_cast<EstimateHealth>(r.health), kEstimateHealthNames) << ',' << r.waypoint
        << ',' << r.length_meas << ',' << r.theta_meas << ',' << r.phi_meas << ',' << r.p_WD[0]
        << ',' << r.p_WD[1] << ',' << r.p_WD[2] << ',' << r.T << ',' << static_cast<int>(r.engaged)
        << ',' << static_cast<int>(r.action) << ',' << r.length_rate << ',' << r.elevation_rate
        << ',' << r.azimuth_rate << '\n';
  }
  return stored;
}

}  // namespace tautline
