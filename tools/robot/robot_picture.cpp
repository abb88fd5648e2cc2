// A robot at its zero posture.
// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/robot_picture.h"

#include "sim/render/renderer.h"
#include "tools/run/outside_view.h"

namespace kaz::tools {
namespace {

// What is drawn of a link, in the link's frame.
std::vector<sim::Visual> looks_of(const sim::RigidLink& link) {
  if (!link.visuals.empty()) return link.visuals;
  std::vector<sim::Visual> looks;
  for (const sim::CollisionShape& collision : link.collisions) {
    if (collision.shape.kind == sim::Shape::Kind::hull) continue;
    sim::Visual& look = looks.emplace_back();
    look.name = link.name + "/" + std::to_string(looks.size());
    look.in_frame = collision.in_link;
    look.shape = collision.shape;
  }
  return looks;
}

}  // namespace

Result<vision::Image> robot_picture(const sim::RobotModel& robot, int width) {
  sim::Scene scene;
  sim::ScenePose pose;
  scene.frames.emplace_back("world");
  pose.frames.push_back(Eigen::Isometry3d::Identity());
  for (const sim::RobotLink& link : robot.links) {
    for (sim::Visual look : looks_of(link.rigid)) {
      look.frame = static_cast<int>(scene.frames.size());
      scene.visuals.push_back(std::move(look));
    }
    scene.frames.push_back(link.rigid.name);
    pose.frames.push_back(link.at_zero);
  }
  if (scene.visuals.empty())
    return fail(Fault::usage, "the robot has no visuals and no collision shapes to draw");
  Framing framing = framing_of(scene, pose);
  const Eigen::AlignedBox3d shapes = robot.extent();
  if (!shapes.isEmpty()) framing = {shapes.center(), shapes.diagonal().norm()};
  auto renderer = KAZ_TRY(sim::make_raster_renderer());
  KAZ_TRY(renderer->set_scene(scene));
  vision::Image picture;
  KAZ_TRY(renderer->render(pose, outside_view(scene, framing, width), picture));
  return picture;
}

}  // namespace kaz::tools
