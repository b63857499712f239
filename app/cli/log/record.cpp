// `tautline log record`: one log for each arming, in a folder with a quota.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>
#include <tautline/log_status_t.hpp>

#include "app/cli/log/log_command.h"
#include "app/cli/termination.h"
#include "app/log/flight_recorder.h"
#include "common/clock.h"
#include "lcmtypes/channels.h"
#include "lcmtypes/lcm_access.h"

namespace tautline::cli {
namespace {

struct Options {
  std::string folder{"."};
  std::uint64_t quota{4ULL << 30U};
  std::string lcm_url{kDefaultLcmUrl};
};

constexpr int kPollMs = 100;
constexpr Duration kStatusPeriod = std::chrono::seconds(1);
// A disk may hold up a sync for seconds; until then the messages wait in LCM's queue.
constexpr int kQueueCapacity = 100'000;

/// Hands messages from LCM to the recorder.
class Subscriber {
 public:
  explicit Subscriber(FlightRecorder& recorder) : recorder_(recorder) {}
  void onMessage(const lcm::ReceiveBuffer* bytes, const std::string& channel) {
    recorder_.onMessage(channel, bytes->recv_utime,
                        {static_cast<const std::uint8_t*>(bytes->data), bytes->data_size},
                        monotonicNow());
  }

 private:
  FlightRecorder& recorder_;
};

/// What the station arms by.
tautline::log_status_t statusOf(const FlightRecorder& recorder, const std::string& folder) {
  constexpr std::int64_t kRoomForAFlight = 200'000'000;
  tautline::log_status_t m{};
  m.utime = toMicroseconds(monotonicNow() + unixOffset());
  m.recording = recorder.diskFull() ? 0 : 1;
  const std::string file = recorder.file().string();
  std::copy_n(file.begin(), std::min(file.size(), sizeof m.file - 1), m.file);
  std::error_code unknown;
  if (!file.empty()) {
    const auto size = std::filesystem::file_size(file, unknown);
    m.bytes = unknown ? 0 : static_cast<std::int64_t>(size);
  }
  const auto space = std::filesystem::space(folder, unknown);
  m.disk_free_bytes = unknown ? 0 : static_cast<std::int64_t>(space.available);
  m.disk_limit_bytes = kRoomForAFlight;
  m.events_lost = recorder.eventsLost();
  return m;
}

void say(const std::string& text) {
  fmt::print("tautline log record: {}\n", text);
  std::fflush(stdout);
}

ExitCode run(const Options& options) {
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error)
    throw InputError({.file = options.folder,
                      .problem = "is no folder and cannot be made: " + error.message(),
                      .remedy = "give --dir a folder that is yours"});
  lcm::LCM lcm(reachable(options.lcm_url));
  if (!lcm.good()) throw cannotJoin(options.lcm_url);
  endOnSignals();
  FlightRecorder recorder({.folder = options.folder, .quota = options.quota}, say);
  Subscriber subscriber(recorder);
  lcm.subscribe(".*", &Subscriber::onMessage, &subscriber)->setQueueCapacity(kQueueCapacity);
  say("waiting for an arming; logs go to " + options.folder);
  Time next_status{};
  for (Time next_tick{}; !termination_requested;) {
    lcm.handleTimeout(kPollMs);
    const Time now = monotonicNow();
    if (now < next_tick) continue;
    next_tick = now + std::chrono::milliseconds(kPollMs);
    recorder.tick(now);
    if (now < next_status) continue;
    next_status = now + kStatusPeriod;
    const tautline::log_status_t status = statusOf(recorder, options.folder);
    lcm.publish(channel::kLogStatus, &status);
  }
  recorder.close();
  return ExitCode::kOk;
}

}  // namespace

void addLogRecord(CLI::App& log, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = log.add_subcommand(
      "record", "One log for each arming: from 2 s before it until 2 s after STANDBY is back");
  verb->add_option("--dir", options->folder, "Folder of the logs")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_option(
          "--quota", options->quota,
          "Bytes that all logs of the folder may take (4GB, 500MB); the oldest finished ones go")
      ->transform(CLI::AsSizeValue(false))
      ->capture_default_str();
  verb->add_option("--lcm-url", options->lcm_url, "Where the station is")->capture_default_str();
  verb->footer(
      "Example: tautline log record --dir flights --quota 2GB\n"
      "Files: <UTC of the arming>_<mission hash|no-mission>_<SIM|HIL|REAL>.lcm; ends by Ctrl-C.");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
