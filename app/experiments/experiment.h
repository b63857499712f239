#pragma once

/// @file
/// What an experiment is: a set-up, independent trials, and the judgement of what came of them:
/// rows "published | as published, simulated | Tautline, simulated | band | pass", tables and
/// pictures. docs/experiments.md. Not real-time safe.

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/experiments/setup.h"
#include "common/plot/figure.h"

namespace tautline::experiments {

/// Where a simulated figure must lie, ends included.
struct Band {
  double min{-std::numeric_limits<double>::infinity()};
  double max{std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool has(double value) const noexcept { return value >= min && value <= max; }
};

/// A figure of the report. A side without a band is told but not judged.
struct Row {
  std::string figure{};  ///< What is measured, e.g. "mean error, straight tether".
  std::string unit{};    ///< "m", "%", …; empty: a number.
  std::optional<double> published{};
  std::optional<double> as_published{};  ///< Simulated.
  std::optional<double> tautline{};      ///< Simulated.
  std::optional<Band> as_published_band{};
  std::optional<Band> tautline_band{};
  std::string note{};       ///< One sentence; may be empty.
  std::string shortfall{};  ///< What limits a goal that is known not to be met: the row does not
                            ///< pass, and does not fail the run. Empty: none is known.
  Band shortfall_limit{};  ///< A figure that misses its band must still lie here, or the run fails.

  /// Every band is met; a band without its figure is not.
  [[nodiscard]] bool pass() const noexcept {
    return met(as_published_band, as_published) && met(tautline_band, tautline);
  }
  /// Does not pass for a known reason, and is no worse than that reason explains.
  [[nodiscard]] bool fallsShort() const noexcept {
    const auto excused = [this](const std::optional<Band>& band,
                                const std::optional<double>& value) {
      return met(band, value) || !value || shortfall_limit.has(*value);
    };
    return !pass() && !shortfall.empty() && excused(as_published_band, as_published) &&
           excused(tautline_band, tautline);
  }

 private:
  static bool met(const std::optional<Band>& band, const std::optional<double>& value) noexcept {
    return !band || (value && band->has(*value));
  }
};

/// A table of numbers: <experiment>_<name>.csv.
struct Sheet {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::string caption{};  ///< Not empty: the table is on the page, too.
};

/// <experiment>_<name>.svg, and on the page.
struct Picture {
  std::string name;
  std::string caption;
  plot::Figure figure;
};

struct Findings {
  std::vector<Row> rows;
  std::vector<Sheet> sheets;
  std::vector<Picture> pictures;
};

/// One flight, or whatever is done at once. Deterministic: `run` depends on nothing but the set-up
/// and what it captured. Its result is kept in a file, so it should be small: figures, and a track
/// where a picture needs it.
struct Trial {
  std::string name;  ///< Unique in the experiment.
  std::function<nlohmann::json()> run;
};

/// What the trials returned, by name.
class Results {
 public:
  explicit Results(std::map<std::string, nlohmann::json> by_trial)
      : by_trial_(std::move(by_trial)) {}
  /// Throws std::out_of_range for a trial that there is not.
  [[nodiscard]] const nlohmann::json& at(const std::string& trial) const {
    return by_trial_.at(trial);
  }

 private:
  std::map<std::string, nlohmann::json> by_trial_;
};

struct Experiment {
  const char* name;   ///< On the command line and in file names.
  const char* title;  ///< On the page.
  const char* setup;  ///< A paragraph: what is flown and what is measured.
  std::vector<Trial> (*trials)(const Setup&);
  Findings (*judge)(const Setup&, const Results&);
};

/// All of them, in the order of the report.
[[nodiscard]] const std::vector<Experiment>& experiments();

/// Those on real flights: a report of their own, for not everybody has the data.
[[nodiscard]] const std::vector<Experiment>& realExperiments();

}  // namespace tautline::experiments
