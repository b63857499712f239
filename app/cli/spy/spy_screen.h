#pragma once

/// @file
/// What `tautline spy` shows and how it answers keys; knows neither LCM nor a terminal. Not
/// real-time safe.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/channel_filter.h"
#include "app/cli/spy/channel_board.h"
#include "app/cli/spy/terminal.h"

namespace tautline::cli {

class SpyScreen {
 public:
  /// Shows channels that `filter` (a regular expression) finds. @throws InputError for a bad one.
  SpyScreen(std::string lcm_url, const std::string& filter);

  /// Takes a key; `live` is what is heard now, to be kept while paused.
  void onKey(int pressed, const ChannelBoard& live, Time now);

  /// The whole screen.
  [[nodiscard]] std::vector<ScreenLine> draw(const ChannelBoard& live, Time now,
                                             Terminal::Size size);

  [[nodiscard]] bool done() const noexcept { return done_; }

  /// The table as text without a screen: its head, and the line of a channel.
  [[nodiscard]] static std::string header();
  [[nodiscard]] static std::string row(const std::string& name, const ChannelMeter& channel,
                                       Time now);

 private:
  struct Frozen {
    ChannelBoard board;
    Time at{};
  };

  void editFilter(int pressed);
  void move(std::ptrdiff_t by, const ChannelBoard& live);
  [[nodiscard]] std::size_t cursorIn(const std::vector<std::string>& names) const;
  [[nodiscard]] std::vector<std::string> matching(const ChannelBoard& board) const;
  [[nodiscard]] std::string title(const ChannelBoard& board, Time now) const;
  [[nodiscard]] std::string hints() const;
  void drawTable(const ChannelBoard& board, Time now, std::size_t rows,
                 std::vector<ScreenLine>& out);
  void drawFields(const ChannelMeter& channel, Time now, std::size_t rows,
                  std::vector<ScreenLine>& out);

  std::string lcm_url_;
  std::string filter_text_;
  ChannelFilter filter_;
  std::optional<std::string> typing_;  // A filter that is being typed,
  std::string complaint_;              // and what was wrong with it.
  std::optional<Frozen> paused_;
  std::string selected_;  // Channel under the cursor.
  bool fields_shown_{false};
  std::size_t scroll_{0};  // First row shown, of the table or of the fields.
  std::size_t page_{1};
  bool done_{false};
};

}  // namespace tautline::cli
