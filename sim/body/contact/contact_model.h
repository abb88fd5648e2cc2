// The shapes of a world that collide: constant data of the collision detection.
// SPDX-License-Identifier: Apache-2.0
//
// Built once, then shared by all clones of a world, also across threads.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/body/description/rigid_link.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {

class ContactModel {
 public:
  // A link of `robot` does not collide with its three nearest ancestors.
  explicit ContactModel(const RobotModel& robot);

  // Adds the collision shapes of one link, except meshes. `body` is the link's number for Contacts::place(),
  // or -1 if the link is fixed in the world at `pose`.
  void add_robot_link(const RigidLink& link, int robot_link, int body,
                      const Eigen::Isometry3d& pose);
  void add_object(const RigidLink& link, int body, const Eigen::Isometry3d& pose);

  struct Geom {
    Shape::Kind kind = Shape::Kind::box;
    int body = -1;                                   // -1: fixed
    double radius = 0;                               // m, bounding sphere
    Eigen::Vector3d size = Eigen::Vector3d::Zero();  // like Shape::size
    Eigen::Vector3d half = Eigen::Vector3d::Zero();  // boxes: half lengths
    Eigen::Vector3d at =
        Eigen::Vector3d::Zero();  // position from the body's center of mass; if fixed: in the world
    // Orientation in the body's axes; if fixed: in the world.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Surface surface;
  };
  // All shapes of one body, or one fixed shape.
  struct Part {
    int body = -1;
    std::size_t first = 0, count = 0;  // range of geoms()
    // Bounding sphere, m. The center is relative to the body's center of mass, in the body's axes; for a
    // fixed shape in the world frame.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0;
  };
  // Points x with normal . x = offset; world frame, m.
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
  // Pairs of indices into robot() that may collide.
  const std::vector<std::pair<std::size_t, std::size_t>>& selves() const { return selves_; }
  // Name of the link to which the shape belongs; for objects "model/link".
  const std::string& name(std::uint32_t shape) const { return names_[shape]; }

 private:
  void add(const RigidLink& link, int robot_link, int body, const Eigen::Isometry3d& pose);
  void add_fixed(int robot_link);
  void add_plane(const Eigen::Isometry3d& at);
  void pair_with_robot(std::size_t part, int robot_link);

  std::size_t bodies_ = 0;
  std::vector<Geom> geoms_;
  std::vector<std::string> names_;  // by geom: name of the geom's link
  std::vector<Plane> planes_;
  std::vector<Part> robot_, objects_, fixed_;
  std::vector<int> robot_link_;  // by index into robot_
  std::vector<std::pair<std::size_t, std::size_t>> selves_;
  // exempt_[a * links + b] is 1 for links so close in the tree that their shapes may overlap at the joints.
  std::vector<char> exempt_;
  std::size_t robot_links_;
};

}  // namespace kaz::sim
