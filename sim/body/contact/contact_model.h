// Constant data of the collision detection: the collision shapes of a world.
// SPDX-License-Identifier: Apache-2.0
//
// A ContactModel is built once. All clones of a world share the ContactModel, even if the clones run in
// different threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/body/description/rigid_link.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {

class ContactModel {
 public:
  // A link of `robot` does not collide with the three nearest ancestors of the link.
  explicit ContactModel(const RobotModel& robot);

  // Adds the collision shapes of one link. Contacts::place() uses the number
  // `body` for this link. If the link is fixed in the world at `pose`, `body` is -1.
  void add_robot_link(const RigidLink& link, int robot_link, int body,
                      const Eigen::Isometry3d& pose);
  // Objects with the same `group` do not collide with each other, except with a plane.
  void add_object(const RigidLink& link, int body, const Eigen::Isometry3d& pose, int group = -1);

  struct Geom {
    Shape::Kind kind = Shape::Kind::box;
    int body = -1;                                   // -1: the shape is fixed in the world
    double radius = 0;                               // radius of the bounding sphere, m
    Eigen::Vector3d size = Eigen::Vector3d::Zero();  // dimensions, as in Shape::size
    Eigen::Vector3d half = Eigen::Vector3d::Zero();  // boxes: half lengths
    // Position relative to the body's center of mass. For a fixed shape: position in the world frame.
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    // Orientation in the body's axes. For a fixed shape: orientation in the world frame.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Surface surface;
    std::shared_ptr<const ConvexHull> hull;  // hulls only
    std::uint16_t mask = 0xffff;             // as in CollisionShape
  };
  // All shapes of one body, or one fixed shape.
  struct Part {
    int body = -1;
    int group = -1;                    // -1: none
    std::size_t first = 0, count = 0;  // range of indices into geoms()
    // Bounding sphere, m. `centre` is relative to the body's center of mass, in the body's axes. For a fixed
    // shape, `centre` is in the world frame.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0;
  };
  // A plane in the world frame. `normal` is a unit vector. `offset` is the distance (m) from the origin to
  // the plane, positive in the direction of `normal`.
  struct Plane {
    std::size_t geom = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0;
  };

  std::size_t bodies() const { return bodies_; }
  const std::vector<Geom>& geoms() const { return geoms_; }
  const std::vector<Plane>& planes() const { return planes_; }
  const Plane& plane_of(std::size_t geom) const;  // `geom` must be a plane
  const std::vector<Part>& robot() const { return robot_; }
  const std::vector<Part>& objects() const { return objects_; }
  const std::vector<Part>& fixed() const { return fixed_; }
  static bool can_collide(const Part& a, const Part& b) {
    return a.group < 0 || a.group != b.group;
  }
  // Pairs of robot parts that can collide, as indices into robot().
  const std::vector<std::pair<std::size_t, std::size_t>>& selves() const { return selves_; }
  // Name of the link to which a shape belongs; for objects "model/link". `shape` is an index into geoms().
  const std::string& name(std::uint32_t shape) const { return names_[shape]; }

 private:
  void add(const RigidLink& link, int robot_link, int body, const Eigen::Isometry3d& pose,
           int group);
  void add_fixed(int robot_link, int group);
  void add_plane(const Eigen::Isometry3d& at);
  void pair_with_robot(std::size_t part, int robot_link);

  std::size_t bodies_ = 0;
  std::vector<Geom> geoms_;
  std::vector<std::string> names_;  // name of each geom's link
  std::vector<Plane> planes_;
  std::vector<Part> robot_, objects_, fixed_;
  std::vector<int> robot_link_;  // for each element of robot_, the number of its link
  std::vector<std::pair<std::size_t, std::size_t>> selves_;
  // exempt_[a * robot_links_ + b] is 1 if the links a and b do not collide. These links are close to each
  // other in the tree, so their shapes can overlap at the joints.
  std::vector<char> exempt_;
  std::size_t robot_links_;
};

}  // namespace kaz::sim
