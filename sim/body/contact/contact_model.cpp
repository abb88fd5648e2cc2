// Shapes that collide.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contact_model.h"

#include <algorithm>
#include <cmath>

#include "sim/body/description/convex_hull.h"

namespace kaz::sim {
namespace {

// Links up to this many joints apart do not collide: a thigh with the foot, a forearm with the trunk.
constexpr int kExemptGenerations = 3;

// Radius of the bounding sphere about the shape's origin, m.
double radius_about(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case Shape::Kind::box:
      return s.norm() / 2;
    case Shape::Kind::cylinder:
      return std::hypot(s.x(), s.y() / 2);
    case Shape::Kind::capsule:
      return s.x() + s.y() / 2;
    case Shape::Kind::hull: {
      double farthest = 0;
      for (std::size_t i = 0; i < shape.hull->size(); ++i)
        farthest = std::max(farthest, shape.hull->point(i).norm());
      return farthest;
    }
    default:
      return s.x();
  }
}

}  // namespace

ContactModel::ContactModel(const RobotModel& robot) : robot_links_(robot.links.size()) {
  exempt_.assign(robot_links_ * robot_links_, 0);
  for (std::size_t link = 0; link < robot_links_; ++link) {
    exempt_[link * robot_links_ + link] = 1;
    int ancestor = static_cast<int>(link);
    for (int up = 0; up < kExemptGenerations; ++up) {
      ancestor = robot.links[static_cast<std::size_t>(ancestor)].parent;
      if (ancestor < 0) break;
      exempt_[link * robot_links_ + static_cast<std::size_t>(ancestor)] = 1;
      exempt_[static_cast<std::size_t>(ancestor) * robot_links_ + link] = 1;
    }
  }
}

void ContactModel::add_robot_link(const RigidLink& link, int robot_link, int body,
                                  const Eigen::Isometry3d& pose) {
  add(link, robot_link, body, pose, -1);
}

void ContactModel::add_object(const RigidLink& link, int body, const Eigen::Isometry3d& pose,
                              int group) {
  add(link, -1, body, pose, group);
}

// The last geom is a plane.
void ContactModel::add_plane(const Eigen::Isometry3d& at) {
  const Eigen::Vector3d normal = at.linear().col(2);
  planes_.push_back({geoms_.size() - 1, normal, normal.dot(at.translation())});
}

const ContactModel::Plane& ContactModel::plane_of(std::size_t geom) const {
  return *std::ranges::find(planes_, geom, &Plane::geom);
}

// The last geom does not move.
void ContactModel::add_fixed(int robot_link, int group) {
  Part part;
  part.group = group;
  part.first = geoms_.size() - 1;
  part.count = 1;
  part.centre = geoms_.back().at;
  part.radius = geoms_.back().radius;
  if (robot_link < 0) {
    fixed_.push_back(part);
    return;
  }
  robot_.push_back(part);
  pair_with_robot(robot_.size() - 1, robot_link);
}

void ContactModel::add(const RigidLink& link, int robot_link, int body,
                       const Eigen::Isometry3d& pose, int group) {
  Part whole;
  whole.body = body;
  whole.group = group;
  whole.first = geoms_.size();
  bodies_ = std::max(bodies_, static_cast<std::size_t>(body + 1));
  const bool moves = body >= 0;
  std::vector<Eigen::Vector3d> centres;
  for (const CollisionShape& shape : link.collisions) {
    const Eigen::Isometry3d at = moves ? shape.in_link : pose * shape.in_link;
    Geom& geom = geoms_.emplace_back();
    names_.push_back(link.name);
    geom.kind = shape.shape.kind;
    geom.size = shape.shape.size;
    geom.surface = shape.surface;
    geom.hull = shape.shape.hull;
    geom.mask = shape.mask;
    geom.half = shape.shape.size / 2;
    geom.radius = radius_about(shape.shape);
    if (geom.kind == Shape::Kind::plane) {
      add_plane(at);
      continue;
    }
    geom.axes = at.linear();
    geom.at = at.translation();
    if (!moves) {
      add_fixed(robot_link, group);
      continue;
    }
    geom.body = body;
    geom.at -= link.com;
    centres.push_back(geom.at);
  }
  if (centres.empty()) return;
  whole.count = centres.size();
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < whole.count; ++i) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(geoms_[whole.first + i].radius);
    box.extend(centres[i] + reach);
    box.extend(centres[i] - reach);
  }
  whole.centre = whole.count == 1 ? centres[0] : box.center();
  for (std::size_t i = 0; i < whole.count; ++i) {
    whole.radius =
        std::max(whole.radius, (centres[i] - whole.centre).norm() + geoms_[whole.first + i].radius);
  }
  if (robot_link < 0) {
    objects_.push_back(whole);
  } else {
    robot_.push_back(whole);
    pair_with_robot(robot_.size() - 1, robot_link);
  }
}

void ContactModel::pair_with_robot(std::size_t part, int robot_link) {
  robot_link_.push_back(robot_link);
  for (std::size_t other = 0; other < part; ++other) {
    const auto a = static_cast<std::size_t>(robot_link_[other]);
    const auto b = static_cast<std::size_t>(robot_link);
    const bool one_moves = robot_[other].body >= 0 || robot_[part].body >= 0;
    if (one_moves && !exempt_[a * robot_links_ + b]) selves_.emplace_back(other, part);
  }
}

}  // namespace kaz::sim
