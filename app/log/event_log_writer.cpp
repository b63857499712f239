#include "app/log/event_log_writer.h"

#include <fcntl.h>
#include <stdio_ext.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "common/error.h"

namespace tautline {

EventLogWriter::EventLogWriter(const std::filesystem::path& file)
    : log_(lcm_eventlog_create(file.c_str(), "w")) {
  if (!log_) {
    throw InputError({.file = file.string(),
                      .problem = std::string("cannot be written: ") + std::strerror(errno),
                      .remedy = "choose a folder that exists and is yours"});
  }
  constexpr std::size_t kBuffer = 1U << 16U;  // liblcm writes an event in six pieces
  std::setvbuf(log_->f, nullptr, _IOFBF, kBuffer);
  ::flock(::fileno(log_->f), LOCK_EX | LOCK_NB);
}

EventLogWriter::~EventLogWriter() { flush(); }

bool EventLogWriter::write(std::string_view channel, std::int64_t utime,
                           std::span<const std::uint8_t> data) noexcept {
  lcm_eventlog_event_t event{};
  event.timestamp = utime;
  event.channellen = static_cast<std::int32_t>(channel.size());
  event.datalen = static_cast<std::int32_t>(data.size());
  // liblcm's struct is the reader's too; its writer changes nothing behind these pointers.
  event.channel = const_cast<char*>(channel.data());
  event.data = const_cast<std::uint8_t*>(data.data());
  log_->eventcount = number_++;
  ++written_;
  if (lcm_eventlog_write_event(log_.get(), &event) == 0) return true;
  dropUnflushed();
  return false;
}

bool EventLogWriter::flush() noexcept {
  if (std::fflush(log_->f) != 0) {
    dropUnflushed();
    return false;
  }
  flushed_written_ = written_;
  flushed_end_ = ::ftello(log_->f);
  return true;
}

bool EventLogWriter::sync() noexcept { return flush() && ::fdatasync(::fileno(log_->f)) == 0; }

void EventLogWriter::skip() noexcept { ++number_; }

void EventLogWriter::dropUnflushed() noexcept {
  const int why = errno;
  ::__fpurge(log_->f);
  std::clearerr(log_->f);
  // Shortening a file needs no room, so only the file's end can be where it was not before.
  [[maybe_unused]] const int cut = ::ftruncate(::fileno(log_->f), flushed_end_);
  ::fseeko(log_->f, flushed_end_, SEEK_SET);
  written_ = flushed_written_;
  errno = why;
}

bool isBeingWritten(const std::filesystem::path& file) noexcept {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return locked;
}

}  // namespace tautline
