#include "app/cli/black_box_command.h"

#include <iostream>
#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "app/station/black_box.h"

namespace tautline::cli {

void addBlackBoxCommand(CLI::App& root, ExitCode& result) {
  const auto file = std::make_shared<std::string>("/dev/shm/tautline-station.blackbox");
  CLI::App* verb = root.add_subcommand(
      "blackbox", "Print the station's last cycles as CSV, also after it was killed");
  verb->add_option("file", *file, "black box file (black_box in the station's config)")
      ->capture_default_str();
  verb->footer("Example: tautline blackbox /dev/shm/tautline-station.blackbox > last_cycles.csv");
  verb->callback([file, &result] {
    BlackBox::print(*file, std::cout);
    result = ExitCode::kOk;
  });
}

}  // namespace tautline::cli
