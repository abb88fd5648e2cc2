// walking_table: many episodes of the walking behaviors, and their tables.
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "shared/base/enum_names.hpp"
#include "tests/studies/common/program.h"
#include "tests/studies/common/table.h"
#include "tests/studies/walking/score.h"

namespace {

using namespace kaz;
using namespace kaz::walking;

struct Arguments {
  studies::EpisodeOptions episodes{.seeds = 20, .out = "out/walking"};
  std::string mcu = "h8";
  bool trace = false;
};

std::string description(const Trial& trial, const Outcome& outcome) {
  return studies::text("%s %.3f m, aside %+.3f m, heading %+.2f deg, %.1f s",
                       outcome.fell                ? "FELL"
                       : succeeded(trial, outcome) ? "done"
                                                   : "MISSED",
                       outcome.forward_m, outcome.aside_m, outcome.heading_deg, outcome.seconds);
}

Result<void> run(const Arguments& arguments, const std::string& command) {
  const auto chosen = KAZ_TRY(studies::matching_rows(walking::trials(), arguments.episodes.rows));
  studies::EpisodeStudy study{.name = "walking", .variants = {arguments.mcu}};
  for (const Trial& trial : chosen) study.rows.push_back(trial.name);
  if (arguments.episodes.list) {
    for (const std::string& row : study.rows) std::printf("%s\n", row.c_str());
    return {};
  }
  study.run = [&](std::size_t row, const studies::EpisodeKey& key) {
    Setting setting;
    setting.mcu = parse_enum(sim::kMcuKinds, key.variant).value();
    setting.image_path = KAZ_FIRMWARE_IMAGE;
    setting.robot_folder = KAZ_ROBOT;
    setting.trace = arguments.trace;
    return run_trial(chosen[row], setting, key.seed);
  };
  study.describe = [&](std::size_t row, const Outcome& outcome) {
    return description(chosen[row], outcome);
  };
  const auto file = KAZ_TRY(studies::run_study(study, arguments.episodes));

  std::string markdown = table(file, chosen, arguments.mcu);
  if (const std::string odometry = odometry_table(file, chosen, arguments.mcu); !odometry.empty())
    markdown += "\n" + odometry;
  std::printf("%s", markdown.c_str());
  const std::string& out = arguments.episodes.out;
  auto done =
      studies::write_tables(out, "table", markdown, summary_json(file, chosen, arguments.mcu));
  if (done) {
    done = studies::write_markdown(arguments.episodes.markdown, command,
                                   std::to_string(file.seeds()) + " seeds", markdown);
  }
  return done ? write_plots(file, arguments.mcu, out) : done;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "go-forward and the turns through host, wire and firmware, by seed, friction and supply, "
      "with and without gyro. Finished episodes are kept and not run again.");
  studies::add_episode_options(app, arguments.episodes);
  app.add_option("--mcu", arguments.mcu, "h8: emulated firmware; native: the same C, compiled")
      ->check(CLI::IsMember(enum_names(sim::kMcuKinds)))
      ->capture_default_str();
  app.add_flag("--trace", arguments.trace, "print the robot's pose every 0.4 s, on standard error");
  app.footer("walking_table --seeds 5 --rows '^walk 1 m$'");
  return studies::run_program(app, "walking_table", argc, argv,
                              [&] { return run(arguments, studies::command_line(argc, argv)); });
}
