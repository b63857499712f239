// `tautline log export`: decoded messages as CSV tables, or as JSON lines that a converter can put
// into an MCAP file with message encoding "json" as they are.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/cli/channel_filter.h"
#include "app/cli/log/log_command.h"
#include "app/log/event_log_reader.h"
#include "app/log/message_decoder.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string log;
  std::string channels;
  std::string csv;
  std::string jsonl;
};

[[noreturn]] void cannotWrite(const fs::path& file) {
  throw InputError({.file = file.string(),
                    .problem = "cannot be written",
                    .remedy = "choose a folder that exists, is yours and has room"},
                   ExitCode::kFailed);
}

/// RFC 4180: quotes where they are needed.
std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

/// A table for each channel; one more if its type changes within the log.
class CsvTables {
 public:
  explicit CsvTables(fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) cannotWrite(folder_);
  }

  void add(const LogEvent& event, const MessageInfo& info, const DecodedMessage& message) {
    const auto fields = flatten(info, message);
    auto [entry, is_new] = tables_.try_emplace({std::string(event.channel), info.name});
    std::ofstream& out = entry->second;
    if (is_new) {
      out.open(pathFor(event.channel, info));
      out << "log_time_us";
      for (const FlatField& field : fields) out << ',' << csvCell(field.name);
      out << '\n';
    }
    out << event.utime;
    for (const FlatField& field : fields) out << ',' << csvCell(field.value);
    out << '\n';
  }

  void finish() {
    for (auto& [key, out] : tables_) {
      if (!out.flush()) cannotWrite(folder_ / key.first);
    }
    fmt::print(stderr, "{} tables in {}\n", tables_.size(), folder_.string());
  }

 private:
  fs::path pathFor(std::string_view channel, const MessageInfo& info) const {
    std::string name(channel);
    std::replace(name.begin(), name.end(), '/', '_');
    const bool first = std::none_of(tables_.begin(), tables_.end(), [&](const auto& table) {
      return table.first.first == channel && table.first.second != info.name;
    });
    return folder_ / (first ? name + ".csv" : name + '.' + info.name + ".csv");
  }

  fs::path folder_;
  std::map<std::pair<std::string, std::string>, std::ofstream> tables_;  // By channel and type.
};

std::string jsonLine(const LogEvent& event, const MessageInfo& info, DecodedMessage message) {
  const auto utime = message.find("utime");
  const std::int64_t sent = utime != message.end() && utime->is_number_integer()
                                ? utime->get<std::int64_t>()
                                : event.utime;
  const DecodedMessage line{{"topic", event.channel},
                            {"sequence", event.number},
                            {"log_time_ns", event.utime * 1000},
                            {"publish_time_ns", sent * 1000},
                            {"schema", info.name},
                            {"data", std::move(message)}};
  return line.dump(-1, ' ', false, DecodedMessage::error_handler_t::replace);
}

ExitCode run(const Options& options) {
  EventLogReader reader(options.log);
  const ChannelFilter wanted(options.channels, "--channel");
  std::optional<CsvTables> tables;
  std::ofstream file;
  if (!options.csv.empty()) tables.emplace(options.csv);
  if (!options.jsonl.empty() && options.jsonl != "-") file.open(options.jsonl);
  std::ostream& lines = options.jsonl == "-" ? std::cout : file;
  std::int64_t exported = 0;
  std::int64_t unknown = 0;
  while (const auto event = reader.next()) {
    if (!wanted.matches(event->channel)) continue;
    const MessageInfo* info = findMessage(event->data);
    auto message = info == nullptr ? std::nullopt : decode(*info, event->data);
    if (!message) {
      ++unknown;
      continue;
    }
    ++exported;
    if (tables) tables->add(*event, *info, *message);
    if (!options.jsonl.empty()) lines << jsonLine(*event, *info, std::move(*message)) << '\n';
  }
  if (tables) tables->finish();
  if (!options.jsonl.empty() && !lines.flush()) cannotWrite(options.jsonl);
  fmt::print(stderr, "{} messages exported, {} of no known type left out\n", exported, unknown);
  if (const std::string damage = summary(reader.damage()); !damage.empty())
    fmt::print(stderr, "the log is {}\n", damage);
  return ExitCode::kOk;
}

}  // namespace

void addLogExport(CLI::App& log, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = log.add_subcommand("export", "Decoded messages as CSV tables or JSON lines");
  verb->add_option("log", options->log, "LCM log, whole or damaged")->required()->type_name("LOG");
  verb->add_option("--channel", options->channels,
                   "Only channels in whose name this regular expression is found")
      ->type_name("RE");
  CLI::Option* csv =
      verb->add_option("--csv", options->csv, "Folder for one table a channel")->type_name("DIR");
  verb->add_option("--jsonl", options->jsonl,
                   "File for one JSON object a message, ready for MCAP's JSON encoding; -: stdout")
      ->type_name("FILE")
      ->excludes(csv);
  verb->footer(
      "Example: tautline log export flight.lcm --channel 'ESTIMATE|COMMAND$' --csv tables");
  verb->callback([options, &result] {
    if (options->csv.empty() && options->jsonl.empty())
      throw CLI::RequiredError("--csv or --jsonl");
    result = run(*options);
  });
}

}  // namespace tautline::cli
