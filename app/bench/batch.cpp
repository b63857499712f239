#include "app/bench/batch.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "common/clock.h"
#include "common/error.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;

constexpr char kSeparator = '\t';
constexpr char kCut = '\x18';  // ASCII CAN

/// Lines "key<TAB>result", each written at once. A process that was killed in its midst leaves half
/// a line; whoever comes next ends it with a mark, for good.
class ResultFile {
 public:
  explicit ResultFile(const std::string& folder) {
    if (folder.empty()) return;
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    path_ = (fs::path(folder) / "results.txt").string();
    bool whole = true;
    std::string line;
    for (std::ifstream in(path_); std::getline(in, line);) {
      whole = !in.eof();
      const std::size_t tab = line.find(kSeparator);
      if (whole && tab != std::string::npos && line.back() != kCut)
        known_[line.substr(0, tab)] = line.substr(tab + 1);
    }
    file_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail();
    if (!whole) write(std::string(1, kCut));
  }
  ~ResultFile() {
    if (file_ >= 0) ::close(file_);
  }
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  [[nodiscard]] const std::string* find(const std::string& key) const {
    const auto found = known_.find(key);
    return found == known_.end() ? nullptr : &found->second;
  }
  void add(const std::string& key, const std::string& line) {
    if (file_ >= 0) write(key + kSeparator + line);
  }

 private:
  void write(const std::string& line) const {
    const std::string text = line + '\n';
    if (::write(file_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) fail();
  }
  [[noreturn]] void fail() const {
    throw InputError({.file = path_,
                      .problem = std::string("cannot be written: ") + std::strerror(errno),
                      .remedy = "choose another folder"},
                     ExitCode::kFailed);
  }

  std::string path_;
  int file_{-1};
  std::map<std::string, std::string> known_;
};

/// On a terminal a line that stays one line; elsewhere a line a minute.
class Progress {
 public:
  Progress(std::size_t total, std::string what)
      : total_(total), what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

  void add(bool failed) {
    ++done_;
    failed_ += failed ? 1U : 0U;
    const Time now = monotonicNow();
    if (now < next_) return;
    next_ = now + (terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(60));
    const double left =
        toSeconds(now - began_) / static_cast<double>(done_) * static_cast<double>(total_ - done_);
    fmt::print(stderr, "{}{} of {} {}{}, {:.0f} s to go {}", terminal_ ? "\r" : "", done_, total_,
               what_, failed_ > 0 ? fmt::format(", {} failed", failed_) : "", left,
               terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
  void end() const {
    if (terminal_) fmt::print(stderr, "\r{:70}\r", "");
  }

 private:
  std::size_t total_;
  std::string what_;
  std::size_t done_{0};
  std::size_t failed_{0};
  bool terminal_;
  Time began_{monotonicNow()};
  Time next_{terminal_ ? Time{} : began_ + std::chrono::seconds(60)};
};

}  // namespace

BatchResult runBatch(const Batch& batch) {
  ResultFile file(batch.folder);
  BatchResult result;
  result.outcomes.resize(batch.keys.size());
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < batch.keys.size(); ++i) {
    const std::string* known = file.find(batch.keys[i]);
    if (known != nullptr) {
      result.outcomes[i].line = *known;
    } else {
      left.push_back(i);
    }
  }
  result.known = batch.keys.size() - left.size();

  const Time began = monotonicNow();
  Progress progress(left.size(), batch.what);
  PoolJob job;
  job.count = left.size();
  job.workers = batch.workers;
  job.run = [&](std::size_t k) { return batch.run(left[k]); };
  job.each = [&](std::size_t k, const JobOutcome& outcome) {
    result.outcomes[left[k]] = outcome;
    if (outcome.failure.empty()) file.add(batch.keys[left[k]], outcome.line);
    if (batch.each) batch.each(left[k], outcome);
    progress.add(!outcome.failure.empty() || (batch.failed && batch.failed(outcome)));
  };
  runAll(job);
  progress.end();
  result.wall_s = toSeconds(monotonicNow() - began);
  return result;
}

Shard parseShard(const std::string& text) {
  Shard s;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, s.index);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, s.count) : first;
  const bool good =
      slash && second.ec == std::errc{} && second.ptr == end && s.index >= 1 && s.index <= s.count;
  if (good) return s;
  throw InputError({.key = "--shard",
                    .problem = "\"" + text + "\" is none",
                    .allowed = "I/N with 1 <= I <= N, e.g. 2/4"},
                   ExitCode::kUsage);
}

}  // namespace tautline::bench
