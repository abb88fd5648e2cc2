// Report about a robot's description.
// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/check_robot.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "shared/picture/png.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/urdf_writer.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/robot/board_file.h"
#include "tools/robot/robot_picture.h"
#include "tools/robot/starter_files.h"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPictureWidth = 960;  // px

// Number or, for infinity, null: JSON has no infinity.
Json limit_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// A use of the robot, and the files that it needs and the robot's folder lacks.
struct Need {
  const char* use;
  std::string missing;  // empty: nothing
};

std::vector<Need> needs_of(const sim::RobotModel& robot, const std::string& file) {
  const auto missing = [&file](const char* name) {
    std::error_code ignored;
    return !std::filesystem::exists(std::filesystem::path(file).replace_filename(name), ignored);
  };
  const auto add = [](std::string& to, const std::string& what) {
    to += (to.empty() ? "" : ", ") + what;
  };
  Need board{"simulation with a servo board", {}}, bus{"servo bus, real or virtual", {}};
  for (const char* name : {"motor.xml", "sensors.xml"})
    if (missing(name)) add(board.missing, name);
  if (const auto limits = limits_for_board(robot); !limits.empty()) {
    const std::string name = board_file_name(file);
    add(board.missing, "limits that the board permits (" + std::to_string(limits.size()) +
                           " joints): use " + name +
                           (missing(name.c_str()) ? ", which --write writes" : ""));
  }
  for (const char* name : {"bus.json", "motor.xml"})
    if (missing(name)) add(bus.missing, name);
  return {board, bus};
}

std::string limit_text(double value, const char* format) {
  char text[32] = "none";
  if (std::isfinite(value)) std::snprintf(text, sizeof text, format, value);
  return text;
}

const std::string& leader_of(const sim::RobotModel& robot, const sim::RobotJoint& follower) {
  return robot.joints[static_cast<std::size_t>(follower.follows->joint)].name;
}

// Null: the joint has a motor.
Json follows_json(const sim::RobotModel& robot, const sim::RobotJoint& joint) {
  if (!joint.follows) return nullptr;
  return {{"joint", leader_of(robot, joint)},
          {"ratio", joint.follows->ratio},
          {"offset_rad", joint.follows->offset}};
}

void print(const sim::RobotModel& robot, const CheckRobotOptions& options) {
  std::size_t shapes = 0;
  for (const sim::RobotLink& link : robot.links) shapes += link.rigid.collisions.size();
  print_lines("%s: %zu joints, %zu links, %.3f kg, %zu collision shapes%s\n", robot.name.c_str(),
              robot.motors(), robot.frames.size(), robot.mass(), shapes,
              robot.fixed_base ? ", fixed to the world" : "");
  std::printf("%-28s %9s %9s %9s %9s\n", "joint", "lower/rad", "upper/rad", "rad/s", "Nm");
  for (const sim::RobotJoint& joint : robot.joints)
    print_lines("%-28s %9s %9s %9s %9s\n", joint.name.c_str(),
                limit_text(joint.lower, "%.4f").c_str(), limit_text(joint.upper, "%.4f").c_str(),
                limit_text(joint.velocity, "%.3g").c_str(),
                limit_text(joint.effort, "%.3g").c_str());
  for (const sim::RobotJoint& joint : robot.joints)
    if (joint.pinion_m > 0)
      print_lines("%s is prismatic: its servo turns a pinion, %.4g m per rad\n", joint.name.c_str(),
                  joint.pinion_m);
  for (const sim::RobotJoint& joint : robot.joints)
    if (joint.follows)
      print_lines("%s = %g * %s %+g rad (no motor)\n", joint.name.c_str(), joint.follows->ratio,
                  leader_of(robot, joint).c_str(), joint.follows->offset);
  if (!robot.notes.empty() && !options.verbose)
    print_lines("not used: %s; --verbose lists the lines\n", sim::summary(robot.notes).c_str());
  for (const sim::FileNote& note : robot.notes)
    if (options.verbose)
      print_lines("%s:%d: %s is not used\n", (note.path.empty() ? options.file : note.path).c_str(),
                  note.line, note.what.c_str());
  for (const Need& need : needs_of(robot, options.file))
    print_lines("%s: %s\n", need.use,
                need.missing.empty() ? "ready" : ("missing " + need.missing).c_str());
}

Json json_of(const sim::RobotModel& robot, const CheckRobotOptions& options) {
  Json joints = Json::array(), links = Json::array(), notes = Json::array(), needs = Json::object();
  for (const sim::RobotJoint& joint : robot.joints)
    joints.push_back({{"name", joint.name},
                      {"lower_rad", limit_json(joint.lower)},
                      {"upper_rad", limit_json(joint.upper)},
                      {"velocity_rad_s", limit_json(joint.velocity)},
                      {"effort_nm", limit_json(joint.effort)},
                      {"damping_nms", joint.damping},
                      {"friction_nm", joint.friction},
                      {"meters_per_rad", joint.pinion_m > 0 ? Json(joint.pinion_m) : Json()},
                      {"follows", follows_json(robot, joint)}});
  for (const sim::RobotLink& link : robot.links)
    links.push_back({{"name", link.rigid.name},
                     {"mass_kg", link.rigid.mass},
                     {"collisions", link.rigid.collisions.size()}});
  for (const sim::FileNote& note : robot.notes)
    notes.push_back({{"file", note.path.empty() ? options.file : note.path},
                     {"line", note.line},
                     {"what", note.what}});
  for (const Need& need : needs_of(robot, options.file)) needs[need.use] = need.missing;
  return {{"robot", robot.name}, {"mass_kg", robot.mass()},        {"fixed_base", robot.fixed_base},
          {"joints", joints},    {"moving_links", links},          {"not_used", notes},
          {"missing", needs},    {"provenance", provenance_json()}};
}

// Paths of meshes are relative to the folder of the written file.
Result<void> write_urdf(const sim::RobotModel& robot, OutputFile& file) {
  std::error_code error;
  const auto folder =
      std::filesystem::canonical(std::filesystem::absolute(file.path()).parent_path(), error);
  return file.write(sim::urdf_of(robot, folder.string()));
}

}  // namespace

Result<void> check_robot(const CheckRobotOptions& options) {
  // Large meshes take seconds. Scripts need no progress.
  Progress progress("kaz robot check", options.json || ::isatty(STDERR_FILENO) == 0);
  progress.update(0, "reading meshes");
  const auto robot = KAZ_TRY(sim::load_robot(options.file, options.reading));
  progress.done();
  std::optional<OutputFile> drawn, urdf;
  if (!options.urdf.empty()) urdf = KAZ_TRY(OutputFile::open(options.urdf, "--urdf"));
  if (!options.picture.empty()) drawn = KAZ_TRY(OutputFile::open(options.picture, "--picture"));
  std::vector<std::string> written;
  std::string board_file;
  if (options.write) {
    written = KAZ_TRY(write_starter_files(robot, options.file));
    board_file = KAZ_TRY(write_board_file(options.file, limits_for_board(robot)));
  }
  if (options.json)
    print_json(json_of(robot, options));
  else
    print(robot, options);
  for (const std::string& name : written)
    if (!options.json) print_lines("wrote %s; correct its values for your robot\n", name.c_str());
  if (urdf) KAZ_TRY(write_urdf(robot, *urdf));
  if (urdf && !options.json) print_lines("URDF: %s\n", options.urdf.c_str());
  if (!board_file.empty() && !options.json) print_lines("%s\n", board_file.c_str());
  if (!drawn) return {};
  progress.update(0.5, "drawing");
  const auto image = KAZ_TRY(robot_picture(robot, kPictureWidth));
  const auto png = KAZ_TRY(
      picture::encode_png({.width = image.width, .height = image.height, .samples = image.rgb}));
  KAZ_TRY(drawn->write({reinterpret_cast<const char*>(png.data()), png.size()}));
  progress.done();
  if (!options.json) print_lines("picture: %s\n", options.picture.c_str());
  return {};
}

}  // namespace kaz::tools
