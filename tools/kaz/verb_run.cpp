// `kaz run`: one behaviour on a real or virtual robot.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "host/behavior/behavior.h"
#include "tools/kaz/options.h"
#include "tools/kaz/run_options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

std::string behavior_names() {
  std::string names;
  for (const auto& behavior : behavior::behaviors()) {
    names += (names.empty() ? "" : ", ") + std::string(behavior.name);
  }
  return names;
}

// Behaviours and their options, for the help text.
std::string behavior_list() {
  std::string list = "Behaviours and their options (--set NAME=VALUE):\n";
  for (const auto& behavior : behavior::behaviors()) {
    list += "  " + std::string(behavior.name) + ": " + std::string(behavior.text) + "\n";
    for (const auto& option : behavior.options) {
      list += "      " + std::string(option.name) + " (" + std::string(option.initial) +
              "): " + std::string(option.text) + "\n";
    }
  }
  return list;
}

}  // namespace

void add_run(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("run", "one behaviour on a real or virtual robot");
  auto arguments = std::make_shared<RunArguments>();
  auto& session = arguments->session;
  verb->add_option("BEHAVIOUR", session.behavior,
                   "one of: " + behavior_names() + "; or a plug-in, ./NAME.so")
      ->required()
      ->type_name("");
  verb->add_option("--robot", session.backend.robot, "sim, or serial:PATH[@BAUD]")
      ->capture_default_str();
  add_address(*verb, session.backend.address);
  verb->add_option("--camera", session.backend.camera,
                   "sim, the path of a camera socket, or v4l2:LEFT,RIGHT[,fps=N][,format=NAME]")
      ->capture_default_str();
  verb->add_option("--calibration", session.backend.calibration,
                   "of v4l2 cameras (kaz calibrate stereo); it says which size they are run at")
      ->type_name("FILE");
  verb->add_option("--out", session.out, "folder for pictures and result.json; none if not given");
  verb->add_flag(
      "--profile", session.profile,
      "measure CPU and waiting time of each part of the program; a table, and in result.json");
  add_run_options(*verb, *arguments);
  verb->get_option("--record-pictures")->needs("--out");  // else there is no recording
  verb->footer(
      behavior_list() +
      "A behaviour of your own, built outside of Kaz: docs/howto/own-behavior.md. It runs with "
      "your rights.\n"
      "Examples:\n"
      "  kaz run search-ball\n"
      "  kaz run track-ball --seed 3 --duration 12 --out three\n"
      "  kaz run catch-ball --world catch --eyes real --imu --out caught\n"
      "  kaz run track-ball --robot serial:/dev/ttyUSB0 --camera board.eyes\n"
      "  kaz run ./wave.so --set times=2\n"
      "  kaz run track-ball --robot serial:/dev/ttyUSB0 \\\n"
      "      --camera v4l2:/dev/video0,/dev/video2 --calibration stereo.yml\n"
      "With a port nothing of the simulator is used; --world, --mcu, --image and --seed "
      "are then\nwithout effect.");
  verb->callback(
      [&action, arguments] { action = [arguments] { return run_behavior(*arguments); }; });
}

}  // namespace kaz::tools
