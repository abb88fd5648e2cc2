// Joints of a robot other than Kaz, from the file that its user gives.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/robot_joints.h"

#include <cstdio>

#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"
#include "tools/base/paths.h"

namespace kaz::tools {

Result<std::vector<std::string>> other_joints(const std::string& robot_file) {
  if (robot_file.empty()) return std::vector<std::string>();
  const auto robot = KAZ_TRY(sim::load_robot(robot_file, {.body = false}));
  std::vector<std::string> joints = robot.joint_order();
  if (joints.size() > KZ_JOINTS)
    return fail(Fault::usage, robot_file + ": the robot has " + std::to_string(joints.size()) +
                                  " joints; the servo board has channels for " +
                                  std::to_string(KZ_JOINTS));
  if (robot.is_kaz()) return std::vector<std::string>();
  return joints;
}

void print_unused(const std::string& label, const std::string& robot_file) {
  if (robot_file.empty()) return;
  const auto robot = sim::load_robot(robot_file, {.body = false});
  if (!robot || robot->notes.empty()) return;
  std::fprintf(stderr, "%s: %s: not used: %s; `kaz robot check` lists the lines\n", label.c_str(),
               robot_file.c_str(), sim::summary(robot->notes).c_str());
}

void print_unused_of_world(const std::string& label, const std::string& world) {
  const auto path = world_file(world);
  if (!path) return;
  const auto loaded = sim::load_world(*path, {.skip_missing_meshes = true});
  if (!loaded || loaded->notes.empty()) return;
  std::fprintf(stderr, "%s: %s: not used: %s\n", label.c_str(), path->c_str(),
               sim::summary(loaded->notes).c_str());
}

}  // namespace kaz::tools
