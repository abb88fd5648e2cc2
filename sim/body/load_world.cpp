// Loads robot and world, and puts them on a dynamics engine.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <vector>

#include "shared/base/number_text.hpp"
#include "sim/body/description/xml_file.h"
#include "sim/body/ode/ode_world.h"
#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/stage_model.h"

namespace kaz::sim {

std::string SolverDiagnostics::summary() const {
  if (unconverged_steps == 0) return "";
  const bool negligible = drift <= kNegligibleDrift;  // not if it is no number
  char text[400];
  std::snprintf(
      text, sizeof text,
      "contact and friction forces did not converge in %lld step%s from %.3f s to %.3f s; the "
      "largest velocity error is %.1e m/s or rad/s, and the position error is at most %.2g mm or "
      "mrad; %s",
      static_cast<long long>(unconverged_steps), unconverged_steps == 1 ? "" : "s", first_s, last_s,
      max_residual, 1e3 * drift,
      negligible ? "these errors are negligible, and the result is reliable"
                 : "later results are unreliable: try a shorter --physics-step, or compare with "
                   "--dynamics exact");
  return text;
}
namespace {

constexpr int kReduced = -1;

// "exact": 0; "quickN": N; "reduced": kReduced.
Result<int> iterations_of(const std::string& dynamics) {
  if (dynamics == "reduced") return kReduced;
  if (dynamics == "exact") return 0;
  const std::string quick = "quick";
  if (dynamics.compare(0, quick.size(), quick) == 0) {
    const auto iterations = parse_number<int>(std::string_view(dynamics).substr(quick.size()));
    if (iterations && *iterations >= 1 && *iterations <= 1000) return *iterations;
  }
  return fail(Fault::usage,
              "unknown dynamics `" + dynamics +
                  "` (--dynamics); use `reduced`, `exact`, or `quickN` with N from 1 to 1000");
}

// Each push of the world is on a link of the robot that can move, and its feet are links of the robot.
Result<void> check_pushes(const WorldModel& world, const RobotModel& robot, bool hung) {
  for (const std::string& foot : world.feet) {
    if (!robot.frames.contains(foot))
      return fail(Fault::usage, "<kaz:robot first_step> names the link `" + foot +
                                    "`, which the robot does not have");
  }
  for (const Push& push : world.pushes) {
    const auto frame = robot.frames.find(push.link);
    if (frame == robot.frames.end())
      return fail(Fault::usage, "the world has a <kaz:push> on the link `" + push.link +
                                    "`, which the robot does not have");
    if (frame->second.link == 0 && (hung || robot.fixed_base))
      return fail(Fault::usage,
                  "the world has a <kaz:push> on the link `" + push.link + "`, which is fixed");
  }
  return {};
}

// ODE's engines know no joints that follow other joints.
Result<void> check_followers(const RobotModel& robot) {
  for (const RobotJoint& joint : robot.joints) {
    if (joint.follows)
      return fail(Fault::usage,
                  "joint `" + joint.name + "` follows joint `" +
                      robot.joints[static_cast<std::size_t>(joint.follows->joint)].name +
                      "`, which only --dynamics reduced supports; leave out --dynamics");
  }
  return {};
}

// ODE's passive hinges measure angles within half a turn, and damping and friction share one row.
Result<void> check_passive_joints(const WorldModel& world) {
  for (const WorldJoint& joint : world.joints) {
    const auto beyond = [](double limit) { return std::isfinite(limit) && std::abs(limit) > 3.1; };
    const bool turns = joint.kind == WorldJoint::Kind::revolute;
    const char* why = nullptr;
    if (turns && (beyond(joint.lower) || beyond(joint.upper))) why = "a limit beyond 3.1 rad";
    if (joint.damping > 0 && joint.friction > 0) why = "damping and friction";
    if (why == nullptr) continue;
    return fail(Fault::usage, "joint `" + joint.name + "` of the world has " + why +
                                  ", which only --dynamics reduced supports; leave out --dynamics");
  }
  return {};
}

// ODE's bodies have mass. Its hinges turn, and measure angles within half a turn.
Result<void> check_hinges(const RobotModel& robot) {
  for (std::size_t i = robot.fixed_base ? 1 : 0; i < robot.links.size(); ++i) {
    if (robot.links[i].rigid.mass > 0) continue;
    return fail(Fault::usage, "link `" + robot.links[i].rigid.name +
                                  "` has no mass, which only --dynamics reduced supports; leave "
                                  "out --dynamics");
  }
  for (const RobotJoint& joint : robot.joints) {
    if (joint.pinion_m > 0)
      return fail(Fault::usage, "joint `" + joint.name +
                                    "` is prismatic, which only --dynamics reduced supports; "
                                    "leave out --dynamics");
  }
  constexpr double kLargestLimit = 3.1;  // rad; the stop is one degree beyond the limit
  for (const RobotJoint& joint : robot.joints) {
    if (joint.lower >= -kLargestLimit && joint.upper <= kLargestLimit) continue;
    return fail(Fault::usage, "joint `" + joint.name +
                                  "` can turn beyond 3.1 rad, which only --dynamics reduced "
                                  "supports; leave out --dynamics");
  }
  return {};
}

// Of a part of the robot: the middle of each shape, and the corners of the box around it, 5 mm within.
std::vector<Eigen::Vector3d> points_of(const RigidLink& link) {
  std::vector<Eigen::Vector3d> points;
  for (const CollisionShape& one : link.collisions) {
    const Eigen::AlignedBox3d box = extent(one.shape, one.in_link);
    if (box.isEmpty()) continue;
    const Eigen::Vector3d middle = box.center(),
                          half = (box.sizes() / 2).array().max(0.005).matrix() -
                                 Eigen::Vector3d::Constant(0.005);
    points.push_back(middle);
    for (int corner = 0; corner < 8; ++corner)
      points.push_back(middle + Eigen::Vector3d((corner & 1) != 0 ? 1 : -1,
                                                (corner & 2) != 0 ? 1 : -1,
                                                (corner & 4) != 0 ? 1 : -1)
                                    .cwiseProduct(half));
  }
  return points;
}

// A robot that starts within something is pushed out with a force that breaks it, or it is stuck.
Result<void> check_start(const std::string& path, const WorldModel& world,
                         const RobotModel& robot) {
  constexpr double kDeep = 0.005;  // m
  const Eigen::Isometry3d root = root_at_start(world, robot, false);
  for (const RobotLink& link : robot.links) {
    for (const Eigen::Vector3d& point : points_of(link.rigid)) {
      const Eigen::Vector3d at = root * link.at_zero * point;
      for (const WorldBody& body : world.bodies)
        for (const CollisionShape& one : body.rigid.collisions)
          if (inside(one.shape, (body.pose * one.in_link).inverse() * at, kDeep))
            return fail(Fault::usage, path + ": the robot starts inside the model `" + body.model +
                                          "` (its link `" + link.rigid.name +
                                          "`); move the model, or change the pose in <kaz:robot>");
    }
  }
  return {};
}

// Returns whether a shape of the world is within 0.3 m of the robot beside it, by bounding boxes. Planes and
// meshes do not count.
bool is_crowded(const WorldModel& world, const RobotModel& robot) {
  constexpr double kClear = 0.3;  // m
  const Eigen::Isometry3d root = root_at_start(world, robot, false);
  Eigen::AlignedBox3d box;
  for (const RobotLink& link : robot.links) {
    for (const CollisionShape& one : link.rigid.collisions)
      box.extend(extent(one.shape, root * link.at_zero * one.in_link));
  }
  if (box.isEmpty()) return false;
  const Eigen::Vector3d clear(kClear, kClear, 0);
  const Eigen::AlignedBox3d free(box.min() - clear, box.max() + clear);
  for (const WorldBody& body : world.bodies) {
    for (const CollisionShape& one : body.rigid.collisions)
      if (free.intersects(extent(one.shape, body.pose * one.in_link))) return true;
  }
  return false;
}

// Moves the start to the nearest free place on circles about the origin. Without one, the start stays.
void move_to_free_place(WorldModel& world, const RobotModel& robot) {
  constexpr double kStep = 0.5, kFarthest = 50;  // m
  constexpr int kDirections = 8;
  const Eigen::Isometry3d stated = world.robot_start;
  for (double radius = kStep; radius <= kFarthest; radius += kStep) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDirections;
      world.robot_start.translation() =
          stated.translation() + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      if (!is_crowded(world, robot)) return;
    }
  }
  world.robot_start = stated;
}

// Worlds of other programs do not state where the robot starts.
Result<bool> states_start(const std::string& world_path) {
  const auto file = XmlFile::load(world_path, "sdf");
  if (!file) return tl::unexpected(file.error());
  const auto* world = file->root().FirstChildElement("world");
  return world != nullptr && world->FirstChildElement("kaz:robot") != nullptr;
}

Result<WorldFiles> read_around(const std::string& world_path, const std::string& robot_path,
                               RobotModel robot, const WorldOptions& options) {
  WorldFiles files;
  files.robot = std::move(robot);
  const std::string motor_path = std::filesystem::path(robot_path).replace_filename("motor.xml");
  files.motor = KAZ_TRY(load_motor_file(motor_path, options.motor));
  if (options.ideal_motors) files.motor = files.motor.ideal();
  files.world = KAZ_TRY(load_world(world_path, options.reading));
  const bool blocked = !options.hung && !check_start(world_path, files.world, files.robot);
  if (blocked && !KAZ_TRY(states_start(world_path))) move_to_free_place(files.world, files.robot);
  return files;
}

}  // namespace

Result<std::unique_ptr<StagedWorld>> make_world(const WorldModel& world, const RobotModel& robot,
                                                const MotorParams& motor,
                                                const WorldOptions& options) {
  const Result<int> iterations = iterations_of(options.dynamics);
  if (!iterations) return tl::unexpected(iterations.error());
  if (!(options.step_s > 0 && options.step_s <= 0.01)) {
    return fail(Fault::usage, "physics step " + std::to_string(options.step_s) +
                                  " s: must be above 0 and at most 0.01 s; the default is 0.001 s");
  }
  KAZ_TRY(check_pushes(world, robot, options.hung));
  if (*iterations == kReduced) return std::make_unique<ReducedWorld>(world, robot, motor, options);
  KAZ_TRY(check_followers(robot));
  KAZ_TRY(check_passive_joints(world));
  if (motor.servo)
    return fail(
        Fault::usage,
        "the motor `" + motor.name +
            "` has a <servo>, which only --dynamics reduced supports; leave out --dynamics");
  return std::make_unique<OdeWorld>(world, robot, motor, options, *iterations);
}

Result<WorldFiles> read_world_files(const std::string& world_path, const std::string& robot_path,
                                    const WorldOptions& options) {
  auto robot = KAZ_TRY(load_robot(robot_path, options.reading));
  return read_around(world_path, robot_path, std::move(robot), options);
}

Result<std::unique_ptr<World>> World::load(const std::string& world_path,
                                           const std::string& robot_path,
                                           const WorldOptions& options) {
  KAZ_TRY(iterations_of(options.dynamics));
  const auto robot = KAZ_TRY(load_robot(robot_path, options.reading));
  return load_with(robot, world_path, robot_path, options);
}

Result<std::unique_ptr<World>> World::load_with(const RobotModel& robot,
                                                const std::string& world_path,
                                                const std::string& robot_path,
                                                const WorldOptions& options) {
  const int iterations = KAZ_TRY(iterations_of(options.dynamics));
  const auto files = KAZ_TRY(read_around(world_path, robot_path, robot, options));
  if (iterations != kReduced) KAZ_TRY(check_hinges(files.robot));
  if (!options.hung) KAZ_TRY(check_start(world_path, files.world, files.robot));
  return make_world(files.world, files.robot, files.motor, options);
}

}  // namespace kaz::sim
