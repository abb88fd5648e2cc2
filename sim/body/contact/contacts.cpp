// Collision detection: bounding spheres, separating axes of boxes, ODE's colliders.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "sim/body/contact/contact_surface.h"

namespace kaz::sim {
namespace {

// Max contact points per pair of shapes: a box on a plane has four corners, two boxes rarely need more.
constexpr int kContactsPerPair = 4;
// Links up to this many joints apart do not collide: a thigh with the foot, a forearm with the trunk.
constexpr int kExemptGenerations = 3;
// Boxes count as separated only beyond rounding, so that ODE would agree: the result must not depend on
// which face was tried first.
constexpr double kClearlyApart = 1e-9;  // m

// ODE geom of a shape, not placed yet; null for kinds that do not collide.
dGeomID make_geom(const Shape& shape) {
  const Eigen::Vector3d& s = shape.size;
  switch (shape.kind) {
    case Shape::Kind::box:
      return dCreateBox(nullptr, s.x(), s.y(), s.z());
    case Shape::Kind::sphere:
      return dCreateSphere(nullptr, s.x());
    case Shape::Kind::cylinder:
      return dCreateCylinder(nullptr, s.x(), s.y());
    case Shape::Kind::capsule:
      return dCreateCapsule(nullptr, s.x(), s.y());
    case Shape::Kind::plane:
      return dCreatePlane(nullptr, 0, 0, 1, 0);
    case Shape::Kind::mesh:
      break;
  }
  return nullptr;
}

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
    default:
      return s.x();
  }
}

bool apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double reach) {
  return (a - b).squaredNorm() > reach * reach;
}

}  // namespace

void enter_ode() {
  static const int once = dInitODE2(0);
  thread_local const int thread = dAllocateODEDataForThread(dAllocateMaskAll);
  static_cast<void>(once);
  static_cast<void>(thread);
}

Contacts::Contacts(const RobotModel& robot) : robot_links_(robot.links.size()) {
  enter_ode();
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

void Contacts::add_robot_link(const RigidLink& link, int robot_link, int body,
                              const Eigen::Isometry3d& pose) {
  add(link, robot_link, body, pose);
}

void Contacts::add_object(const RigidLink& link, int body, const Eigen::Isometry3d& pose) {
  add(link, -1, body, pose);
}

Contacts::Geom& Contacts::add_geom(const CollisionShape& shape, const Eigen::Isometry3d& at) {
  Geom& geom = geoms_.emplace_back();
  geom.id.reset(make_geom(shape.shape));
  geom.surface = shape.surface;
  geom.box = shape.shape.kind == Shape::Kind::box;
  geom.half = shape.shape.size / 2;
  geom.radius = radius_about(shape.shape);
  if (shape.shape.kind == Shape::Kind::plane) {
    const Eigen::Vector3d normal = at.linear().col(2);
    const double offset = normal.dot(at.translation());
    dGeomPlaneSetParams(geom.id.get(), normal.x(), normal.y(), normal.z(), offset);
    planes_.push_back({geoms_.size() - 1, normal, offset});
  }
  return geom;
}

void Contacts::add(const RigidLink& link, int robot_link, int body, const Eigen::Isometry3d& pose) {
  Part whole;
  whole.body = body;
  whole.first = geoms_.size();
  if (body >= static_cast<int>(bodies_.size())) {
    bodies_.resize(static_cast<std::size_t>(body) + 1);
  }
  const bool moves = body >= 0;
  std::vector<Eigen::Vector3d> centres;
  for (const CollisionShape& shape : link.collisions) {
    if (shape.shape.kind == Shape::Kind::mesh) continue;
    const Eigen::Isometry3d at = moves ? shape.in_link : pose * shape.in_link;
    Geom& geom = add_geom(shape, at);
    geom.name = link.name;
    if (shape.shape.kind == Shape::Kind::plane) continue;
    geom.turn = at.linear();
    if (moves) {
      geom.body = body;
      geom.in_body = at.translation() - link.com;
      centres.push_back(geom.in_body);
      continue;
    }
    geom.at = at.translation();
    geom.axes = at.linear();
    const dGeomID id = geom.id.get();
    dMatrix3 rotation;
    to_ode(geom.axes, rotation);
    dGeomSetPosition(id, geom.at.x(), geom.at.y(), geom.at.z());
    dGeomSetRotation(id, rotation);
    Part part;
    part.first = geoms_.size() - 1;
    part.count = 1;
    part.at = geom.at;
    part.radius = geom.radius;
    if (robot_link < 0) {
      fixed_.push_back(part);
    } else {
      robot_.push_back(part);
      pair_with_robot(robot_.size() - 1, robot_link);
    }
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

void Contacts::pair_with_robot(std::size_t part, int robot_link) {
  robot_link_.push_back(robot_link);
  spheres_.resize(robot_.size());
  for (std::size_t other = 0; other < part; ++other) {
    const auto a = static_cast<std::size_t>(robot_link_[other]);
    const auto b = static_cast<std::size_t>(robot_link);
    const bool one_moves = robot_[other].body >= 0 || robot_[part].body >= 0;
    if (one_moves && !exempt_[a * robot_links_ + b]) selves_.emplace_back(other, part);
  }
}

void Contacts::place(int body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& com,
                     bool awake) {
  bodies_[static_cast<std::size_t>(body)] = {axes, com, awake};
}

const Eigen::Vector3d& Contacts::at(Geom& geom) const {
  if (geom.body >= 0 && geom.at_round != round_) {
    const Body& body = bodies_[static_cast<std::size_t>(geom.body)];
    geom.at = body.com + body.axes * geom.in_body;
    geom.at_round = round_;
  }
  return geom.at;
}

const Eigen::Matrix3d& Contacts::axes(Geom& geom) const {
  if (geom.body >= 0 && geom.axes_round != round_) {
    geom.axes = bodies_[static_cast<std::size_t>(geom.body)].axes * geom.turn;
    geom.axes_round = round_;
  }
  return geom.axes;
}

// The ODE geom at its present world pose.
dGeomID Contacts::placed(Geom& geom) const {
  const dGeomID id = geom.id.get();
  if (geom.body < 0) return id;
  const Eigen::Vector3d& centre = at(geom);
  dMatrix3 rotation;
  to_ode(axes(geom), rotation);
  dGeomSetPosition(id, centre.x(), centre.y(), centre.z());
  dGeomSetRotation(id, rotation);
  return id;
}

void Contacts::place_parts() {
  ++round_;
  const auto place = [this](Part& part) {
    if (part.body < 0) return;
    const Body& body = bodies_[static_cast<std::size_t>(part.body)];
    part.at = body.com + body.axes * part.centre;
    part.awake = body.awake;
  };
  low_.setConstant(1e300);
  high_.setConstant(-1e300);
  robot_moves_ = false;
  for (Part& part : robot_) {
    place(part);
    low_ = low_.cwiseMin((part.at.array() - part.radius).matrix());
    high_ = high_.cwiseMax((part.at.array() + part.radius).matrix());
    robot_moves_ = robot_moves_ || part.awake;
  }
  for (Part& part : objects_) place(part);
}

void Contacts::update() {
  enter_ode();
  touches_.clear();
  place_parts();
  for (std::size_t i = 0; i < robot_.size(); ++i) {
    const Part& part = robot_[i];
    spheres_[i] = {part.at.x(), part.at.y(), part.at.z(), part.radius};
  }
  for (const auto& [a, b] : selves_) {
    const Sphere &one = spheres_[a], &other = spheres_[b];
    const double x = one.x - other.x, y = one.y - other.y, z = one.z - other.z;
    const double reach = one.radius + other.radius;
    if (x * x + y * y + z * z <= reach * reach) meet(robot_[a], robot_[b]);
  }
  for (const Part& part : robot_) meet_planes(part);
  for (const Part& part : objects_) meet_planes(part);
  const auto meets_robot = [this](const Part& other) {
    if (!robot_moves_ && !other.awake) return;
    if (((other.at.array() + other.radius) < low_.array()).any() ||
        ((other.at.array() - other.radius) > high_.array()).any()) {
      return;
    }
    for (const Part& part : robot_) meet(part, other);
  };
  for (const Part& fixed : fixed_) meets_robot(fixed);
  for (const Part& object : objects_) meets_robot(object);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    for (std::size_t j = i + 1; j < objects_.size(); ++j) meet(objects_[i], objects_[j]);
    if (!objects_[i].awake) continue;
    for (const Part& fixed : fixed_) meet(objects_[i], fixed);
  }
}

void Contacts::meet(const Part& a, const Part& b) {
  if (apart(a.at, b.at, a.radius + b.radius)) return;
  if (!a.awake && !b.awake) return;
  for (std::size_t i = a.first; i < a.first + a.count; ++i) {
    const Eigen::Vector3d& here = at(geoms_[i]);
    if (apart(here, b.at, geoms_[i].radius + b.radius)) continue;
    for (std::size_t j = b.first; j < b.first + b.count; ++j) {
      if (apart(here, at(geoms_[j]), geoms_[i].radius + geoms_[j].radius)) continue;
      if (geoms_[i].box && geoms_[j].box && parted(i, j)) continue;
      touch(i, j);
    }
  }
}

void Contacts::meet_planes(const Part& part) {
  if (!part.awake) return;
  for (const Plane& plane : planes_) {
    if (plane.normal.dot(part.at) - plane.offset > part.radius) continue;
    for (std::size_t i = part.first; i < part.first + part.count; ++i) {
      if (plane.normal.dot(at(geoms_[i])) - plane.offset <= geoms_[i].radius) touch(i, plane.geom);
    }
  }
}

// Whether a face normal of either box is a separating axis: |n . (c_b - c_a)| > half_k + sum_i |n . b_i|
// half_i, world frame, m (6 of the 15 axes of Gottschalk et al.; the edge pairs are left to ODE).
bool Contacts::parted(std::size_t a, std::size_t b) {
  const Eigen::Matrix3d &ra = axes(geoms_[a]), &rb = axes(geoms_[b]);
  const Eigen::Vector3d between_centres = at(geoms_[b]) - at(geoms_[a]);
  const auto between = [&](int face) {
    const bool of_a = face < 3;
    const int k = of_a ? face : face - 3;
    const Eigen::Vector3d normal = (of_a ? ra : rb).col(k);
    const double reach =
        ((of_a ? rb : ra).transpose() * normal).cwiseAbs().dot(geoms_[of_a ? b : a].half);
    return std::abs(normal.dot(between_centres)) - geoms_[of_a ? a : b].half[k] - reach >
           kClearlyApart;
  };
  Hint& hint = hints_[(a * 31 + b) % hints_.size()];
  if (hint.a == a && hint.b == b && between(hint.face)) return true;
  for (int face = 0; face < 6; ++face) {
    if (!between(face)) continue;
    hint = {a, b, face};
    return true;
  }
  return false;
}

void Contacts::touch(std::size_t a, std::size_t b) {
  Geom &geom_a = geoms_[a], &geom_b = geoms_[b];
  std::array<dContactGeom, kContactsPerPair> found;
  const int count = dCollide(placed(geom_a), placed(geom_b), kContactsPerPair, found.data(),
                             sizeof(dContactGeom));
  if (count == 0) return;
  Touch touch;
  touch.body_a = geom_a.body;
  touch.body_b = geom_b.body;
  touch.shape_a = static_cast<std::uint32_t>(a);
  touch.shape_b = static_cast<std::uint32_t>(b);
  touch.surface = joined(geom_a.surface, geom_b.surface);
  for (int i = 0; i < count; ++i) {
    const dContactGeom& point = found[static_cast<std::size_t>(i)];
    touch.at = to_eigen(point.pos);
    touch.normal = to_eigen(point.normal);
    touch.depth = point.depth;
    touches_.push_back(touch);
  }
}

}  // namespace kaz::sim
