// Joints of a robot other than Kaz, and the unused elements of the files that its user gives.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/robot_joints.h"

#include <algorithm>
#include <cstdio>

#include "shared/base/number_text.hpp"
#include "shared/protocol/messages.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"
#include "tools/base/paths.h"

namespace kaz::tools {
namespace {

constexpr double kLargestRamp = KZ_RAMP_MAX / 10.0;  // rad/s

void print_notes(const std::string& label, const std::string& file,
                 const std::vector<sim::FileNote>& notes, bool verbose) {
  if (!notes.empty() && !verbose)
    std::fprintf(stderr, "%s: %s: not used: %s; --verbose lists the lines\n", label.c_str(),
                 file.c_str(), sim::summary(notes).c_str());
  for (const sim::FileNote& note : notes)
    if (verbose)
      std::fprintf(stderr, "%s: %s:%d: %s is not used\n", label.c_str(), file.c_str(), note.line,
                   note.what.c_str());
}

}  // namespace

Result<std::vector<std::string>> other_joints(const sim::RobotModel& robot,
                                              const std::string& robot_file) {
  std::vector<std::string> joints = robot.joint_order();
  if (joints.size() > KZ_JOINTS)
    return fail(Fault::usage, robot_file + ": the robot has " + std::to_string(joints.size()) +
                                  " joints; the servo board has channels for " +
                                  std::to_string(KZ_JOINTS));
  if (robot.is_kaz()) return std::vector<std::string>();
  return joints;
}

std::vector<std::string> joint_speeds(const sim::RobotModel& robot) {
  std::vector<std::string> speeds;
  bool limited = false;
  for (const sim::RobotJoint& joint : robot.joints) {
    if (joint.follows) continue;
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", std::min(joint.velocity, kLargestRamp));
    speeds.emplace_back(text);
    limited = limited || joint.velocity < kLargestRamp;
  }
  if (!limited) speeds.clear();
  return speeds;
}

Result<std::vector<double>> parse_speeds(const std::vector<std::string>& texts) {
  std::vector<double> speeds;
  for (const std::string& text : texts) {
    const auto speed = parse_number<double>(text);
    if (!speed || !(*speed > 0))
      return fail(Fault::usage, "speed limit `" + text + "`: must be a number above 0, in rad/s");
    speeds.push_back(*speed);
  }
  return speeds;
}

ReadFiles files_of(const BackendOptions& options) {
  return {options.robot_file, options.at_port() ? "" : options.world, options.reading,
          options.verbose, options.robot_model.get()};
}

void print_unused(const std::string& label, const ReadFiles& files) {
  if (files.reading.strict) return;
  sim::ReadOptions reading = files.reading;
  reading.body = files.verbose;
  if (files.robot != nullptr) {
    print_notes(label, files.robot_file, files.robot->notes, files.verbose);
  } else if (!files.robot_file.empty()) {
    if (const auto robot = sim::load_robot(files.robot_file, reading))
      print_notes(label, files.robot_file, robot->notes, files.verbose);
  }
  if (const auto world = world_file(files.world); world && *world == files.world) {
    if (const auto loaded = sim::load_world(*world, reading))
      print_notes(label, *world, loaded->notes, files.verbose);
  }
}

}  // namespace kaz::tools
