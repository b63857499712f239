#pragma once

/// @file
/// A client written only from the protocol's description, for tests: it knows nothing of the
/// simulator or of Tautline's driver.

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace tautline::sim {

/// Telemetry as a client sees it: the last fields of each header, and counts.
class WireClient {
 public:
  void take(const std::string& bytes) {
    pending_ += bytes;
    for (std::size_t end = pending_.find("\r\n"); end != std::string::npos;
         end = pending_.find("\r\n")) {
      line(pending_.substr(0, end));
      pending_.erase(0, end + 2);
    }
  }

  [[nodiscard]] int count(const std::string& header) const {
    const auto it = count_.find(header);
    return it == count_.end() ? 0 : it->second;
  }
  void resetCounts() { count_.clear(); }
  [[nodiscard]] bool has(const std::string& header) const { return text_.count(header) > 0; }
  /// Field of the last line with this header, as text.
  [[nodiscard]] std::string text(const std::string& header, std::size_t field) const {
    return text_.at(header).at(field);
  }
  [[nodiscard]] double number(const std::string& header, std::size_t field) const {
    return std::strtod(text(header, field).c_str(), nullptr);
  }
  [[nodiscard]] std::size_t fieldCount(const std::string& header) const {
    return text_.at(header).size();
  }
  [[nodiscard]] int badLines() const { return bad_lines_; }

  /// What a client sends to take control, line by line.
  [[nodiscard]] static std::string startSequence() {
    return "stop\n\n\n\n\n\nGSLowControl params 2 2\nRemoteControl start\nChecksum 0\n"
           "Pset 117,10.0\nPcommit\nPset 119,0\nPcommit\nGet_GroundStatus 0\nGet_Att 0\nGet_Pos 0\n"
           "Get_FlightStatus 0\nGet_Gimbal 0\n";
  }

 private:
  void line(const std::string& s) {
    const std::size_t space = s.find(' ');
    if (s.empty() || s[0] != '!' || space == std::string::npos ||
        s.find('\n') != std::string::npos) {
      ++bad_lines_;
      return;
    }
    std::vector<std::string> fields;
    std::size_t from = space + 1;
    for (std::size_t comma = s.find(',', from); comma != std::string::npos;
         comma = s.find(',', from)) {
      fields.push_back(s.substr(from, comma - from));
      from = comma + 1;
    }
    fields.push_back(s.substr(from));
    const std::string header = s.substr(0, space);
    text_[header] = fields;
    ++count_[header];
  }

  std::string pending_;
  std::map<std::string, std::vector<std::string>> text_;
  std::map<std::string, int> count_;
  int bad_lines_{0};
};

}  // namespace tautline::sim
