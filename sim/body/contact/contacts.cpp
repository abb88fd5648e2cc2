// Collision detection: bounding spheres, separating axes of boxes, ODE's colliders.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contacts.h"

#include <algorithm>
#include <cmath>

#include "sim/body/contact/capsule_contact.h"
#include "sim/body/contact/contact_surface.h"
#include "sim/body/description/convex_hull.h"

namespace kaz::sim {
namespace {

// Max contact points per pair of shapes: a box on a plane has four corners, two boxes rarely need more.
constexpr int kContactsPerPair = 4;
// Boxes count as separated only beyond rounding, so that ODE would agree: the result must not depend on
// which face was tried first.
constexpr double kClearlyApart = 1e-9;  // m

// ODE's geoms in the order of Shape::Kind. Meshes are only drawn.
template <class Shapes>
void make_geoms(Shapes& shapes) {
  static_assert(static_cast<int>(Shape::Kind::mesh) == std::tuple_size_v<Shapes>);
  const auto reset = [&shapes](Shape::Kind kind, dGeomID geom) {
    shapes[static_cast<std::size_t>(kind)].reset(geom);
  };
  reset(Shape::Kind::box, dCreateBox(nullptr, 1, 1, 1));
  reset(Shape::Kind::cylinder, dCreateCylinder(nullptr, 1, 1));
  reset(Shape::Kind::sphere, dCreateSphere(nullptr, 1));
  reset(Shape::Kind::capsule, dCreateCapsule(nullptr, 1, 1));
  reset(Shape::Kind::plane, dCreatePlane(nullptr, 0, 0, 1, 0));
  // set_hull() replaces these empty arrays.
  static double nothing = 0;
  static unsigned no_polygon = 0;
  reset(Shape::Kind::hull, dCreateConvex(nullptr, &nothing, 0, &nothing, 0, &no_polygon));
}

void set_size(dGeomID geom, Shape::Kind kind, const Eigen::Vector3d& s) {
  switch (kind) {
    case Shape::Kind::box:
      return dGeomBoxSetLengths(geom, s.x(), s.y(), s.z());
    case Shape::Kind::sphere:
      return dGeomSphereSetRadius(geom, s.x());
    case Shape::Kind::cylinder:
      return dGeomCylinderSetParams(geom, s.x(), s.y());
    case Shape::Kind::capsule:
      return dGeomCapsuleSetParams(geom, s.x(), s.y());
    case Shape::Kind::plane:
    case Shape::Kind::hull:
    case Shape::Kind::mesh:
      break;
  }
}

// ODE keeps the pointers and only reads the arrays. The ContactModel keeps them until the next search.
void set_hull(dGeomID geom, const ConvexHull& hull) {
  dGeomSetConvex(geom, hull.planes.data(), static_cast<unsigned>(hull.planes.size() / 4),
                 hull.points.data(), static_cast<unsigned>(hull.size()), hull.polygons.data());
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

Contacts::Contacts() {
  enter_ode();
  make_geoms(of_a_);
  make_geoms(of_b_);
}

Contacts& Contacts::of_this_thread() {
  thread_local Contacts contacts;
  return contacts;
}

void Contacts::begin(const ContactModel& model) {
  model_ = &model;
  touches_.clear();
  bodies_.resize(model.bodies());
  poses_.resize(model.geoms().size());
  spheres_.resize(model.robot().size());
  ++round_;
}

const Eigen::Vector3d& Contacts::at(std::size_t number) {
  const Geom& geom = model_->geoms()[number];
  if (geom.body < 0) return geom.at;
  Pose& pose = poses_[number];
  if (pose.at_round != round_) {
    const Body& body = bodies_[static_cast<std::size_t>(geom.body)];
    pose.at = body.com + body.axes * geom.at;
    pose.at_round = round_;
  }
  return pose.at;
}

const Eigen::Matrix3d& Contacts::axes(std::size_t number) {
  const Geom& geom = model_->geoms()[number];
  if (geom.body < 0) return geom.axes;
  Pose& pose = poses_[number];
  if (pose.axes_round != round_) {
    pose.axes = bodies_[static_cast<std::size_t>(geom.body)].axes * geom.axes;
    pose.axes_round = round_;
  }
  return pose.axes;
}

// ODE's geom with the size and the present world pose of a shape.
dGeomID Contacts::placed(const OdeShapes& shapes, std::size_t number) {
  const Geom& geom = model_->geoms()[number];
  const dGeomID id = shapes[static_cast<std::size_t>(geom.kind)].get();
  if (geom.kind == Shape::Kind::plane) {
    const ContactModel::Plane& plane = model_->plane_of(number);
    dGeomPlaneSetParams(id, plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset);
    return id;
  }
  if (geom.hull) set_hull(id, *geom.hull);
  set_size(id, geom.kind, geom.size);
  const Eigen::Vector3d& centre = at(number);
  dMatrix3 rotation;
  to_ode(axes(number), rotation);
  dGeomSetPosition(id, centre.x(), centre.y(), centre.z());
  dGeomSetRotation(id, rotation);
  return id;
}

void Contacts::place_parts(std::span<const ContactModel::Part> from, std::vector<Part>& to) {
  to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    const ContactModel::Part& part = from[i];
    to[i] = {part.centre, part.radius, part.first, part.count, false};
    if (part.body < 0) continue;
    const Body& body = bodies_[static_cast<std::size_t>(part.body)];
    to[i].at = body.com + body.axes * part.centre;
    to[i].awake = body.awake;
  }
}

void Contacts::meet_robot(const Part& other) {
  if (!robot_moves_ && !other.awake) return;
  if (((other.at.array() + other.radius) < low_.array()).any() ||
      ((other.at.array() - other.radius) > high_.array()).any()) {
    return;
  }
  for (const Part& part : robot_) meet(part, other);
}

void Contacts::update() {
  place_parts(model_->robot(), robot_);
  place_parts(model_->objects(), objects_);
  place_parts(model_->fixed(), fixed_);
  low_.setConstant(1e300);
  high_.setConstant(-1e300);
  robot_moves_ = false;
  for (std::size_t i = 0; i < robot_.size(); ++i) {
    const Part& part = robot_[i];
    low_ = low_.cwiseMin((part.at.array() - part.radius).matrix());
    high_ = high_.cwiseMax((part.at.array() + part.radius).matrix());
    robot_moves_ = robot_moves_ || part.awake;
    spheres_[i] = {part.at.x(), part.at.y(), part.at.z(), part.radius};
  }
  for (const auto& [a, b] : model_->selves()) {
    const Sphere &one = spheres_[a], &other = spheres_[b];
    const double x = one.x - other.x, y = one.y - other.y, z = one.z - other.z;
    const double reach = one.radius + other.radius;
    if (x * x + y * y + z * z <= reach * reach) meet(robot_[a], robot_[b]);
  }
  for (const Part& part : robot_) meet_planes(part);
  for (const Part& part : objects_) meet_planes(part);
  for (const Part& fixed : fixed_) meet_robot(fixed);
  for (const Part& object : objects_) meet_robot(object);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const ContactModel::Part& object = model_->objects()[i];
    for (std::size_t j = i + 1; j < objects_.size(); ++j)
      if (ContactModel::can_collide(object, model_->objects()[j])) meet(objects_[i], objects_[j]);
    if (!objects_[i].awake) continue;
    for (std::size_t j = 0; j < fixed_.size(); ++j)
      if (ContactModel::can_collide(object, model_->fixed()[j])) meet(objects_[i], fixed_[j]);
  }
}

void Contacts::meet(const Part& a, const Part& b) {
  if (apart(a.at, b.at, a.radius + b.radius)) return;
  if (!a.awake && !b.awake) return;
  const std::vector<Geom>& geoms = model_->geoms();
  for (std::size_t i = a.first; i < a.first + a.count; ++i) {
    const Eigen::Vector3d& here = at(i);
    if (apart(here, b.at, geoms[i].radius + b.radius)) continue;
    for (std::size_t j = b.first; j < b.first + b.count; ++j) {
      if (apart(here, at(j), geoms[i].radius + geoms[j].radius)) continue;
      if ((geoms[i].mask & geoms[j].mask) == 0) continue;
      const bool boxes = geoms[i].kind == Shape::Kind::box && geoms[j].kind == Shape::Kind::box;
      if (boxes && parted(i, j)) continue;
      touch(i, j);
    }
  }
}

void Contacts::meet_planes(const Part& part) {
  if (!part.awake) return;
  for (const ContactModel::Plane& plane : model_->planes()) {
    if (plane.normal.dot(part.at) - plane.offset > part.radius) continue;
    for (std::size_t i = part.first; i < part.first + part.count; ++i) {
      if (plane.normal.dot(at(i)) - plane.offset > model_->geoms()[i].radius) continue;
      if ((model_->geoms()[i].mask & model_->geoms()[plane.geom].mask) == 0) continue;
      if (model_->geoms()[i].hull)
        rest(i, plane);
      else
        touch(i, plane.geom);
    }
  }
}

// Whether a face normal of either box is a separating axis: |n . (c_b - c_a)| > half_k + sum_i |n . b_i|
// half_i, world frame, m (6 of the 15 axes of Gottschalk et al.; the edge pairs are left to ODE).
bool Contacts::parted(std::size_t a, std::size_t b) {
  const std::vector<Geom>& geoms = model_->geoms();
  const Eigen::Matrix3d &ra = axes(a), &rb = axes(b);
  const Eigen::Vector3d between_centres = at(b) - at(a);
  const auto between = [&](int face) {
    const bool of_a = face < 3;
    const int k = of_a ? face : face - 3;
    const Eigen::Vector3d normal = (of_a ? ra : rb).col(k);
    const double reach =
        ((of_a ? rb : ra).transpose() * normal).cwiseAbs().dot(geoms[of_a ? b : a].half);
    return std::abs(normal.dot(between_centres)) - geoms[of_a ? a : b].half[k] - reach >
           kClearlyApart;
  };
  Hint& hint = hints_[(a * 31 + b) % hints_.size()];
  if (hint.a == a && hint.b == b && between(hint.face)) return true;
  for (int face = 0; face < 6; ++face) {
    if (!between(face)) continue;
    hint = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), face};
    return true;
  }
  return false;
}

// The contact of two shapes, without a point.
Touch Contacts::contact_of(std::size_t a, std::size_t b) const {
  const Geom &geom_a = model_->geoms()[a], &geom_b = model_->geoms()[b];
  Touch touch;
  touch.body_a = geom_a.body;
  touch.body_b = geom_b.body;
  touch.shape_a = static_cast<std::uint32_t>(a);
  touch.shape_b = static_cast<std::uint32_t>(b);
  touch.surface = joined(geom_a.surface, geom_b.surface);
  return touch;
}

// Adds the contact points of deep_ that span the area.
void Contacts::add_spanning(Touch touch) {
  if (deep_.empty()) return;
  for (const int i : spanning_points(deep_, touch.normal)) {
    if (i < 0) continue;
    touch.at = deep_[static_cast<std::size_t>(i)].first;
    touch.depth = deep_[static_cast<std::size_t>(i)].second;
    touches_.push_back(touch);
  }
}

// A hull on a plane. ODE would take the first four vertices below the plane, which may lie on one side.
void Contacts::rest(std::size_t number, const ContactModel::Plane& plane) {
  const ConvexHull& hull = *model_->geoms()[number].hull;
  const Eigen::Matrix3d& turn = axes(number);
  const Eigen::Vector3d& origin = at(number);
  deep_.clear();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector3d point = origin + turn * hull.point(i);
    const double depth = plane.offset - plane.normal.dot(point);
    if (depth >= 0) deep_.emplace_back(point, depth);
  }
  Touch touch = contact_of(number, plane.geom);
  touch.normal = plane.normal;
  add_spanning(touch);
}

// Two polyhedra, one of them a hull, that touch with about this normal. ODE finds only one point of them, on
// which nothing can stand. False: they do not touch with a face.
bool Contacts::touch_faces(std::size_t a, std::size_t b, double depth, Eigen::Vector3d normal) {
  const Geom &geom_a = model_->geoms()[a], &geom_b = model_->geoms()[b];
  const auto solid = [this](const Geom& geom, std::size_t number) {
    return Polyhedron{geom.hull.get(), geom.half, axes(number), at(number)};
  };
  if (!face_contact(solid(geom_a, a), solid(geom_b, b), depth, normal, deep_)) return false;
  Touch touch = contact_of(a, b);
  touch.normal = normal;
  add_spanning(touch);
  return true;
}

// A capsule on a face of a box. ODE finds only one point of the line, and another one in each step, so the
// capsule would rock. `touch` has the normal; `sign` is 1 if it points to the capsule. False: no such line.
bool Contacts::touch_lying(std::size_t capsule, std::size_t box, double sign, Touch touch) {
  const Geom& round = model_->geoms()[capsule];
  std::array<DeepPoint, 2> ends;
  if (!capsule_on_face({at(capsule), axes(capsule).col(2) * round.half.y(), round.size.x()},
                       {nullptr, model_->geoms()[box].half, axes(box), at(box)},
                       sign * touch.normal, ends))
    return false;
  for (const auto& [point, depth] : ends) {
    touch.at = point;
    touch.depth = depth;
    touches_.push_back(touch);
  }
  return true;
}

void Contacts::touch(std::size_t a, std::size_t b) {
  std::array<dContactGeom, kContactsPerPair> found;
  const int count = dCollide(placed(of_a_, a), placed(of_b_, b), kContactsPerPair, found.data(),
                             sizeof(dContactGeom));
  if (count == 0) return;
  const Geom &geom_a = model_->geoms()[a], &geom_b = model_->geoms()[b];
  const auto has_faces = [](const Geom& geom) {
    return geom.hull || geom.kind == Shape::Kind::box;
  };
  if ((geom_a.hull || geom_b.hull) && has_faces(geom_a) && has_faces(geom_b) &&
      touch_faces(a, b, found[0].depth, to_eigen(found[0].normal)))
    return;
  Touch touch = contact_of(a, b);
  touch.normal = to_eigen(found[0].normal);
  const auto lies_on = [](const Geom& one, const Geom& other) {
    return one.kind == Shape::Kind::capsule && other.kind == Shape::Kind::box;
  };
  if (lies_on(geom_a, geom_b) && touch_lying(a, b, 1, touch)) return;
  if (lies_on(geom_b, geom_a) && touch_lying(b, a, -1, touch)) return;
  for (int i = 0; i < count; ++i) {
    const dContactGeom& point = found[static_cast<std::size_t>(i)];
    touch.at = to_eigen(point.pos);
    touch.normal = to_eigen(point.normal);
    touch.depth = point.depth;
    touches_.push_back(touch);
  }
}

}  // namespace kaz::sim
