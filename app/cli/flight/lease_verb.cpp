/// @file
/// `tautline lease take|release|show`: who may command.

#include <memory>

#include <fmt/format.h>

#include "app/cli/flight/verbs.h"

namespace tautline::cli::flight {
namespace {

constexpr const char* kName = "lease";

ExitCode change(const Options& options, Service service, const char* done) {
  StationClient client(options.lcm_url, Role::kOperator);
  const ExitCode code = ask(client, options, kName, {.service = service});
  return code == ExitCode::kOk ? finish(options, kName, code, done) : code;
}

ExitCode show(const Options& options) {
  StationClient client(options.lcm_url, Role::kListener);
  const auto& v = client.view();
  if (!client.waitUntil([&] { return v.authority.has_value(); },
                        limitOf(options, std::chrono::seconds(5))))
    return noStation(options, kName);
  const auto& a = *v.authority;
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& entry : kAckResultNames)
    if (entry.value != AckResult::kAccepted)
      refused[entry.name] = a.results[static_cast<std::size_t>(entry.value)];
  const nlohmann::json extra{
      {"holder", holderOf(a)},
      {"session", fmt::format("{:x}", static_cast<std::uint64_t>(a.session))},
      {"age_s", a.lease_age_s},
      {"heartbeat_age_s", a.heartbeat_age_s},
      {"left_s", a.lease_left_s},
      {"accepted", a.results[0]},
      {"refused", refused}};
  say(options, kName, ExitCode::kOk,
      a.session == 0 ? std::string("free")
                     : fmt::format("held by {} (session {:x}) for {:.0f} s, last heard {:.1f} s "
                                   "ago, expires in {:.0f} s",
                                   holderOf(a), static_cast<std::uint64_t>(a.session),
                                   a.lease_age_s, a.heartbeat_age_s, a.lease_left_s),
      extra);
  if (options.json || options.quiet) return ExitCode::kOk;
  fmt::print("  {:>8} commands accepted\n", a.results[0]);
  for (const auto& entry : kAckResultNames) {
    const auto count = a.results[static_cast<std::size_t>(entry.value)];
    if (entry.value != AckResult::kAccepted && count != 0)
      fmt::print("  {:>8} refused: {}\n", count, entry.name);
  }
  return ExitCode::kOk;
}

}  // namespace

void addLeaseVerb(CLI::App& root, ExitCode& result) {
  CLI::App* lease =
      root.add_subcommand(kName, "Who may command: one operator holds the lease, all see it");
  lease->require_subcommand(1);
  lease->footer(
      "Example: tautline lease show\n"
      "arm, takeoff, navigate, … take a free lease by themselves. It ends 10 s after the holder's\n"
      "last sign of life. hold, stop, estop, land and return need none. TAUTLINE_OPERATOR in the\n"
      "environment replaces user@host as the operator's name.");
  const auto options = std::make_shared<Options>();
  const auto force = std::make_shared<bool>(false);
  CLI::App* take =
      addVerb(*lease, "take", "Take the lease", "tautline lease take --force", *options);
  take->add_flag("--force", *force, "also from the operator who holds it; the log names both");
  take->callback([options, force, &result] {
    result = change(*options, *force ? Service::kForceLease : Service::kTakeLease,
                    "taken; it ends 10 s after the last sign of life");
  });
  addVerb(*lease, "release", "Give the lease back", "tautline lease release", *options)
      ->callback(
          [options, &result] { result = change(*options, Service::kReleaseLease, "released"); });
  addVerb(*lease, "show", "Holder, age, and what was refused so far", "tautline lease show --json",
          *options)
      ->callback([options, &result] { result = show(*options); });
}

}  // namespace tautline::cli::flight
