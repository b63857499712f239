#include "app/cli/spy/spy_screen.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace tautline::cli {
namespace {

std::string cell(std::optional<double> value, double scale, int digits) {
  return value ? fmt::format("{:.{}f}", *value * scale, digits) : "-";
}

}  // namespace

SpyScreen::SpyScreen(std::string lcm_url, const std::string& filter)
    : lcm_url_(std::move(lcm_url)), filter_text_(filter), filter_(filter, "--filter") {}

std::string SpyScreen::header() {
  return fmt::format("{:20} {:20} {:>8} {:>9} {:>8} {:>9}", "channel", "type", "Hz", "kB/s",
                     "age ms", "jitter ms");
}

std::string SpyScreen::row(const std::string& name, const ChannelMeter& channel, Time now) {
  std::string type = typeNameOf(channel);
  if (channel.type() == nullptr) type += fmt::format(", {} B", channel.lastPacket().size());
  return fmt::format("{:20.20} {:20.20} {:>8} {:>9} {:>8.0f} {:>9}", name, type,
                     cell(channel.rate(now), 1.0, 2), cell(channel.bytesPerSecond(now), 1e-3, 3),
                     toSeconds(channel.age(now)) * 1e3, cell(channel.jitter(), 1e3, 2));
}

std::vector<std::string> SpyScreen::matching(const ChannelBoard& board) const {
  std::vector<std::string> names;
  for (const auto& [name, channel] : board) {
    if (filter_.matches(name)) names.push_back(name);
  }
  return names;
}

std::size_t SpyScreen::cursorIn(const std::vector<std::string>& names) const {
  const auto at = std::find(names.begin(), names.end(), selected_);
  return at == names.end() ? 0 : static_cast<std::size_t>(at - names.begin());
}

void SpyScreen::onKey(int pressed, const ChannelBoard& live, Time now) {
  if (pressed == key::kHangUp) done_ = true;
  if (typing_) return editFilter(pressed);
  const bool back = pressed == key::kEscape || pressed == key::kLeft || pressed == key::kBackspace;
  if (pressed == 'q') done_ = true;
  if (pressed == 'p' || pressed == ' ') {
    paused_ = paused_ ? std::nullopt : std::optional(Frozen{live, now});
  } else if (pressed == '/') {
    typing_ = filter_text_;
    fields_shown_ = false;
  } else if (pressed == key::kUp || pressed == 'k') {
    move(-1, live);
  } else if (pressed == key::kDown || pressed == 'j') {
    move(1, live);
  } else if (pressed == key::kPageUp) {
    move(-static_cast<std::ptrdiff_t>(page_), live);
  } else if (pressed == key::kPageDown) {
    move(static_cast<std::ptrdiff_t>(page_), live);
  } else if ((pressed == key::kEnter || pressed == key::kRight) && !fields_shown_) {
    fields_shown_ = true;
    scroll_ = 0;
  } else if (back && fields_shown_) {
    fields_shown_ = false;
    scroll_ = 0;
  }
}

void SpyScreen::editFilter(int pressed) {
  if (pressed == key::kEscape) {
    typing_.reset();
  } else if (pressed == key::kBackspace) {
    if (!typing_->empty()) typing_->pop_back();
  } else if (pressed >= ' ' && pressed <= '~') {
    *typing_ += static_cast<char>(pressed);
  } else if (pressed == key::kEnter) {
    try {
      filter_ = ChannelFilter(*typing_);
      filter_text_ = *typing_;
      complaint_.clear();
      typing_.reset();
    } catch (const InputError&) {
      complaint_ = "  is none";
    }
  }
}

/// The cursor in the table, or the first row of the fields, which draw() keeps within what is
/// there.
void SpyScreen::move(std::ptrdiff_t by, const ChannelBoard& live) {
  if (fields_shown_) {
    scroll_ = static_cast<std::size_t>(
        std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(scroll_) + by));
    return;
  }
  const auto names = matching(paused_ ? paused_->board : live);
  if (names.empty()) return;
  const auto to = static_cast<std::ptrdiff_t>(cursorIn(names)) + by;
  selected_ = names[static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(to, 0, static_cast<std::ptrdiff_t>(names.size()) - 1))];
}

std::string SpyScreen::title(const ChannelBoard& board, Time now) const {
  double bytes = 0.0;
  for (const auto& [name, channel] : board) bytes += channel.bytesPerSecond(now).value_or(0.0);
  return fmt::format("tautline spy  {}{} channels  {:.1f} kB/s  {}{}", paused_ ? "PAUSED  " : "",
                     board.size(), bytes * 1e-3,
                     filter_text_.empty() ? "" : '/' + filter_text_ + "  ", lcm_url_);
}

std::string SpyScreen::hints() const {
  if (typing_) return "filter (regular expression): " + *typing_ + '_' + complaint_;
  if (fields_shown_) return "Esc back   up/down scroll   p pause   q quit";
  return "up/down choose   Enter fields   / filter   p pause   q quit";
}

void SpyScreen::drawTable(const ChannelBoard& board, Time now, std::size_t rows,
                          std::vector<ScreenLine>& out) {
  const std::vector<std::string> names = matching(board);
  out.push_back({header()});
  if (names.empty()) {
    out.push_back({board.empty() ? "nothing heard yet; is a station running with this --lcm-url?"
                                 : "no channel that the filter finds"});
    return;
  }
  const std::size_t cursor = cursorIn(names);
  selected_ = names[cursor];
  scroll_ = std::clamp(scroll_, cursor + 1 > rows ? cursor + 1 - rows : 0, cursor);
  for (std::size_t i = scroll_; i < std::min(names.size(), scroll_ + rows); ++i)
    out.push_back({row(names[i], board.at(names[i]), now), i == cursor});
}

void SpyScreen::drawFields(const ChannelMeter& channel, Time now, std::size_t rows,
                           std::vector<ScreenLine>& out) {
  const MessageInfo* type = channel.type();
  out.push_back({fmt::format("{}  {}  {} B  {} Hz  age {:.0f} ms  {} messages", selected_,
                             type == nullptr ? "unknown type" : type->name,
                             channel.lastPacket().size(), cell(channel.rate(now), 1.0, 2),
                             toSeconds(channel.age(now)) * 1e3, channel.messages()),
                 true});
  const auto message = type == nullptr ? std::nullopt : decode(*type, channel.lastPacket());
  if (!message) {
    const auto fingerprint = fingerprintOf(channel.lastPacket()).value_or(0);
    out.push_back(
        {fmt::format("not decoded; fingerprint {:016x}", static_cast<std::uint64_t>(fingerprint))});
    return;
  }
  const std::vector<FlatField> fields = flatten(*type, *message);
  scroll_ = std::min(scroll_, fields.size() > rows ? fields.size() - rows : 0);
  constexpr std::size_t kValue = 24;  // columns; a longer one takes the place of the comment
  for (std::size_t i = scroll_; i < std::min(fields.size(), scroll_ + rows); ++i) {
    const FlatField& f = fields[i];
    out.push_back({f.value.size() > kValue
                       ? fmt::format("{:26.26} {}", f.name, f.value)
                       : fmt::format("{:26.26} {:>{}}  {}", f.name, f.value, kValue, f.comment)});
  }
}

std::vector<ScreenLine> SpyScreen::draw(const ChannelBoard& live, Time now, Terminal::Size size) {
  const ChannelBoard& board = paused_ ? paused_->board : live;
  const Time at = paused_ ? paused_->at : now;
  constexpr std::size_t kAround = 3;  // title, head of the table, hints
  page_ = std::max<std::size_t>(1, size.rows > kAround ? size.rows - kAround : 0);
  std::vector<ScreenLine> lines{{title(board, at)}};
  const auto chosen = board.find(selected_);
  if (fields_shown_ && chosen != board.end()) {
    drawFields(chosen->second, at, page_, lines);
  } else {
    drawTable(board, at, page_, lines);
  }
  lines.resize(std::max(lines.size(), size.rows - 1));
  lines.push_back({hints()});
  return lines;
}

}  // namespace tautline::cli
