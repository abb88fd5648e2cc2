// Files of bodies: robots, worlds, meshes.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "sim/body/description/convex_hull.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"
#include "sim/render/model/mesh.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

Complaint judge(const sim::RigidLink& link) {
  if (!(std::isfinite(link.mass) && link.mass >= 0) || !link.com.allFinite() ||
      !link.inertia.allFinite())
    return "link " + link.name + " has an invalid mass, center of mass or inertia";
  for (const sim::CollisionShape& shape : link.collisions) {
    if (!shape.in_link.matrix().allFinite() || !shape.shape.size.allFinite() ||
        shape.shape.kind == sim::Shape::Kind::mesh)
      return "link " + link.name + " has an invalid shape";
  }
  for (const sim::Visual& visual : link.visuals) {
    if (!visual.in_frame.matrix().allFinite() || !visual.shape.size.allFinite())
      return "link " + link.name + " has an invalid visual";
  }
  return std::nullopt;
}

}  // namespace

Complaint try_robot(Bytes bytes) {
  const std::string path = input_file(bytes, "robot.urdf");
  const auto robot = sim::load_robot(path);
  if (!robot) return judge_error(robot.error(), path);
  if (robot->joints.empty()) return "a robot without joints was read";
  for (std::size_t i = 0; i < robot->links.size(); ++i) {
    const sim::RobotLink& link = robot->links[i];
    if (auto wrong = judge(link.rigid)) return wrong;
    if (link.parent >= static_cast<int>(i) || !link.at_zero.matrix().allFinite() ||
        link.joint >= static_cast<int>(robot->joints.size()))
      return "link " + link.rigid.name + " has an invalid parent or joint";
  }
  for (const sim::RobotJoint& joint : robot->joints) {
    if (joint.child < 0 || joint.child >= static_cast<int>(robot->links.size()) ||
        !(std::abs(joint.axis.norm() - 1) < 1e-6) || !(joint.lower < joint.upper))
      return "joint " + joint.name + " is invalid";
    if (joint.follows &&
        (joint.follows->joint < 0 || joint.follows->joint >= static_cast<int>(robot->motors()) ||
         !std::isfinite(joint.follows->ratio * joint.follows->offset)))
      return "joint " + joint.name + " follows no joint with a motor";
  }
  for (const auto& [name, frame] : robot->frames) {
    if (frame.link < 0 || frame.link >= static_cast<int>(robot->links.size()) ||
        !frame.in_link.matrix().allFinite())
      return "frame " + name + " is invalid";
  }
  (void)robot->eyes_link();
  if (!(std::isfinite(robot->mass()))) return "a robot without a mass was read";
  const Eigen::AlignedBox3d extent = robot->extent();
  if (!extent.isEmpty() && !(extent.min().allFinite() && extent.max().allFinite()))
    return "a robot without bounds was read";
  return std::nullopt;
}

Complaint try_world(Bytes bytes) {
  const std::string path = input_file(bytes, "world.sdf");
  const auto world = sim::load_world(path);
  if (!world) return judge_error(world.error(), path);
  if (!world->gravity.allFinite() || !world->robot_start.matrix().allFinite())
    return "an invalid gravity or start was read";
  for (const sim::WorldBody& body : world->bodies) {
    if (auto wrong = judge(body.rigid)) return wrong;
    if (!body.pose.matrix().allFinite()) return "model " + body.model + " has an invalid pose";
    if (!body.fixed && !(body.rigid.mass > 0)) return "model " + body.model + " has no mass";
    for (const sim::Kick& kick : body.kicks) {
      if (!(kick.time_s >= 0) || !kick.velocity.allFinite()) return "an invalid kick was read";
    }
  }
  for (const sim::WorldJoint& joint : world->joints) {
    const int bodies = static_cast<int>(world->bodies.size());
    if (joint.child < 0 || joint.child >= bodies || joint.parent < -1 || joint.parent >= bodies ||
        joint.parent == joint.child || !(std::abs(joint.axis.norm() - 1) < 1e-6) ||
        !joint.anchor.allFinite() || !(joint.lower <= joint.upper) || !(joint.damping >= 0) ||
        !(joint.friction >= 0))
      return "joint " + joint.name + " of the world is invalid";
  }
  return std::nullopt;
}

Complaint judge_hull(const sim::Mesh& mesh) {
  std::vector<Eigen::Vector3d> points;
  for (const sim::Vertex& vertex : mesh.vertices)
    points.emplace_back(vertex.position[0], vertex.position[1], vertex.position[2]);
  const auto hull = sim::convex_hull(points);
  if (!hull) return std::nullopt;
  for (std::size_t i = 0; i < hull->polygons.size(); ++i) {
    const bool is_count = i % 4 == 0;
    if (is_count ? hull->polygons[i] != 3 : hull->polygons[i] >= hull->size())
      return "a hull with an invalid vertex index";
  }
  for (const double value : hull->planes)
    if (!std::isfinite(value)) return "a hull with an invalid face";
  return std::nullopt;
}

Complaint try_mesh(Bytes bytes) {
  if (bytes.empty()) return std::nullopt;
  const char* const name = bytes[0] == 'd' ? "mesh.dae" : bytes[0] % 2 ? "mesh.stl" : "mesh.obj";
  const std::string path = input_file(bytes.subspan(1), name);
  const auto mesh = sim::load_mesh(path, {1, 1, 1});
  if (!mesh) return judge_error(mesh.error(), path);
  if (auto wrong = judge_hull(*mesh)) return wrong;
  if (mesh->indices.empty() || mesh->indices.size() % 3 != 0) return "a mesh without triangles";
  for (const std::uint32_t index : mesh->indices) {
    if (index >= mesh->vertices.size()) return "a triangle with an invalid vertex index";
  }
  for (const sim::Vertex& vertex : mesh->vertices) {
    for (const float value : {vertex.position[0], vertex.position[1], vertex.position[2],
                              vertex.normal[0], vertex.normal[1], vertex.normal[2]}) {
      if (!std::isfinite(value)) return "an invalid vertex";
    }
  }
  return std::nullopt;
}

}  // namespace kaz::fuzz
