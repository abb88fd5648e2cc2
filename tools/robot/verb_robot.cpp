// `kaz robot`: descriptions of robots.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/robot/check_robot.h"

namespace kaz::tools {
namespace {

void add_check(CLI::App& robot, Action& action) {
  auto* verb = robot.add_subcommand("check", "read a URDF or MJCF, and print what Kaz uses of it");
  auto options = std::make_shared<CheckRobotOptions>();
  auto meshes = std::make_shared<sim::RobotOptions>();
  verb->add_option("FILE", options->file, "URDF or MJCF of the robot")->required()->type_name("");
  verb->add_option("--picture", options->picture, "draw the robot at its zero posture, as a PNG")
      ->type_name("FILE");
  verb->add_option("--urdf", options->urdf, "write the robot as a URDF, for other programs")
      ->type_name("FILE");
  verb->add_flag("--write", options->write,
                 "write missing files beside FILE: bus.json, motor.xml, sensors.xml, and NAME.board.urdf "
                 "with limits that the servo board permits");
  add_unused_options(*verb, options->reading.strict, options->verbose);
  verb->add_flag(
      "--joints-only", [options](std::int64_t) { options->reading.body = false; },
      "read only joints and limits, which is enough for a servo bus");
  verb->add_flag("--json", options->json, "print the result as JSON");
  meshes->visit_meshes(OptionAdder(*verb));
  verb->footer(
      "All errors of the file are printed together, with their lines.\n"
      "Exit status: 0 Kaz can use the file, 2 the file has errors.\n"
      "Examples:\n"
      "  kaz robot check so101.urdf\n"
      "  kaz robot check so101.urdf --picture so101.png --write\n"
      "  kaz robot check so101.xml --urdf so101.urdf\n"
      "  KAZ_MESH_PATH=~/my_robot_description kaz robot check robot.urdf --skip-missing-meshes");
  verb->callback([&action, options, meshes] {
    action = [options, meshes]() -> Result<ExitStatus> {
      options->reading.mesh_collision = meshes->reading.mesh_collision;
      options->reading.skip_missing_meshes = meshes->reading.skip_missing_meshes;
      KAZ_TRY(check_robot(*options));
      return ExitStatus();
    };
  });
}

}  // namespace

void add_robot(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("robot", "examine the description of a robot");
  verb->require_subcommand(1);
  verb->footer("Examples:\n  kaz robot check so101.urdf --picture so101.png");
  add_check(*verb, action);
}

}  // namespace kaz::tools
