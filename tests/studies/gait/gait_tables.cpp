// gait_tables: many episodes of the known gait under several implementations of the dynamics.
// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "shared/base/enum_names.hpp"
#include "tests/studies/common/program.h"
#include "tests/studies/gait/report.h"

namespace {

using namespace kaz;
using namespace kaz::gait;

struct Arguments {
  studies::EpisodeOptions episodes{.seeds = 50, .jobs = 2, .out = "out/gait"};
  std::vector<std::string> dynamics{"reduced", "exact"};
  std::string motors = "product", mcu = "h8";
};

const std::map<std::string, Motors> kMotors{
    {"product", Motors::product}, {"ideal", Motors::ideal}, {"reference", Motors::reference}};

Result<void> run(const Arguments& arguments, const std::string& command) {
  const auto chosen = KAZ_TRY(studies::matching_rows(tasks(), arguments.episodes.rows));
  studies::EpisodeStudy study{.name = "gait", .motors = arguments.motors};
  study.variants = arguments.dynamics;
  for (const Task& task : chosen) study.rows.push_back(task.name);
  if (arguments.episodes.list) {
    for (const std::string& row : study.rows) std::printf("%s\n", row.c_str());
    return {};
  }
  study.run = [&](std::size_t row, const studies::EpisodeKey& key) {
    Setting setting;
    setting.stepper = key.variant;
    setting.mcu = parse_enum(sim::kMcuKinds, arguments.mcu).value();
    setting.image_path = KAZ_FIRMWARE_IMAGE;
    setting.robot_folder = KAZ_ROBOT;
    setting.motors = kMotors.at(arguments.motors);
    return run_episode(chosen[row], setting, key.seed);
  };
  study.describe = [](std::size_t, const Outcome& outcome) -> std::string {
    return outcome.fell ? "fell" : outcome.caught ? "caught" : "done";
  };
  const auto file = KAZ_TRY(studies::run_study(study, arguments.episodes));

  const std::string markdown = tables(file, chosen, arguments.dynamics);
  std::printf("%s", markdown.c_str());
  const std::string& out = arguments.episodes.out;
  auto done = studies::write_tables(out, "tables", markdown,
                                    summary_json(file, chosen, arguments.dynamics));
  if (done) {
    done = studies::write_markdown(arguments.episodes.markdown, command,
                                   std::to_string(file.seeds()) + " seeds", markdown);
  }
  return done ? write_plots(file, chosen, arguments.dynamics, out) : done;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Walking, pushes, turning by slip and catching, through host, wire and firmware, under "
      "several implementations of the dynamics. Finished episodes are kept and not run again.");
  studies::add_episode_options(app, arguments.episodes);
  app.add_option("--dynamics", arguments.dynamics, "comma-separated: reduced, exact, quickN")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--motors", arguments.motors,
                 "product: motor.xml; ideal: without backlash and heating; reference: those that "
                 "the gait was found with")
      ->check(CLI::IsMember(kMotors))
      ->capture_default_str();
  app.add_option("--mcu", arguments.mcu, "h8: emulated firmware; native: the same C, compiled")
      ->check(CLI::IsMember(enum_names(sim::kMcuKinds)))
      ->capture_default_str();
  app.footer(
      "gait_tables --seeds 5 --rows '^turn' --dynamics reduced\n"
      "gait_tables --motors ideal --out out/gait-ideal");
  return studies::run_program(app, "gait_tables", argc, argv,
                              [&] { return run(arguments, studies::command_line(argc, argv)); });
}
