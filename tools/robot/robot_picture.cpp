// A robot at its zero posture.
// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/robot_picture.h"

#include <algorithm>

#include "sim/body/description/mesh_file.h"
#include "sim/render/camera.h"
#include "sim/render/renderer.h"

namespace kaz::tools {
namespace {

// Visuals of a link, in the link's frame.
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

// Bounding box of a visual, in the frame of `pose`; empty if the mesh cannot be read.
Eigen::AlignedBox3d box_of(const sim::Visual& look, const Eigen::Isometry3d& pose) {
  if (look.shape.kind != sim::Shape::Kind::mesh) return sim::extent(look.shape, pose);
  Eigen::AlignedBox3d box;
  if (const auto mesh = sim::read_mesh(look.shape.mesh_path, look.shape.size)) {
    for (const Eigen::Vector3d& corner : mesh->corners) box.extend(pose * corner);
  }
  return box;
}

// A view from the front right and from above, which contains the whole box.
sim::View view_of(const Eigen::AlignedBox3d& box, int width) {
  constexpr double kFieldOfView_rad = 0.78, kDistance = 1.75;  // in diagonals of the box
  const Eigen::Vector3d direction = Eigen::Vector3d(1.3, -0.65, 0.8).normalized();
  const double diagonal_m = std::max(box.diagonal().norm(), 0.05);
  sim::View view;
  view.camera = sim::camera_of_view(width, 3 * width / 4, kFieldOfView_rad);
  view.samples_per_axis = 2;
  view.world_from_optical =
      sim::look_at(box.center() + kDistance * diagonal_m * direction, box.center());
  return view;
}

}  // namespace

Result<vision::Image> robot_picture(const sim::RobotModel& robot, int width) {
  sim::Scene scene;
  sim::ScenePose pose;
  scene.frames.emplace_back("world");
  pose.frames.push_back(Eigen::Isometry3d::Identity());
  Eigen::AlignedBox3d box = robot.extent();
  for (const sim::RobotLink& link : robot.links) {
    box.extend(link.at_zero.translation());
    for (sim::Visual look : looks_of(link.rigid)) {
      box.extend(box_of(look, link.at_zero * look.in_frame));
      look.frame = static_cast<int>(scene.frames.size());
      scene.visuals.push_back(std::move(look));
    }
    scene.frames.push_back(link.rigid.name);
    pose.frames.push_back(link.at_zero);
  }
  if (scene.visuals.empty())
    return fail(Fault::usage, "the robot has no visuals and no collision shapes to draw");
  auto renderer = KAZ_TRY(sim::make_raster_renderer());
  KAZ_TRY(renderer->set_scene(scene));
  vision::Image picture;
  KAZ_TRY(renderer->render(pose, view_of(box, width), picture));
  return picture;
}

}  // namespace kaz::tools
