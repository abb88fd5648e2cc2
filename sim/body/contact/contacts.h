// Collision detection: finds all contact points between robot, objects and fixed shapes.
// SPDX-License-Identifier: Apache-2.0
//
// Broad phase: a scene has few shapes, so there is no tree or grid; each link or object has one bounding
// sphere, and pairs of spheres, or a sphere and a plane, are rejected by distance. The robot's own pairs that
// may collide are listed once. Narrow phase: ODE's colliders; two boxes only if no face normal of either is a
// separating axis (Gottschalk et al., SIGGRAPH 1996). Pairs of which neither body can move are skipped.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/body/contact/ode_handles.h"
#include "sim/body/description/rigid_link.h"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {

// A contact point. World frame, m.
struct Touch {
  int body_a = -1, body_b = -1;  // -1: does not move; never both
  std::uint32_t shape_a = 0, shape_b = 0;
  Eigen::Vector3d at, normal;  // normal: unit, direction of the force of b on a
  double depth = 0;            // penetration
  Surface surface;             // of the pair
};

class Contacts {
 public:
  explicit Contacts(const RobotModel& robot);

  // Adds the shapes of one link. `body`: its number for place() and touches(); -1: fixed in the world at
  // `pose`.
  void add_robot_link(const RigidLink& link, int robot_link, int body,
                      const Eigen::Isometry3d& pose);
  void add_object(const RigidLink& link, int body, const Eigen::Isometry3d& pose);

  // Sets the pose of a body: centre of mass and the axes of its link, world frame. Sleeping bodies collide
  // with bodies that are awake only.
  void place(int body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& com, bool awake);
  // Finds the contacts of the poses set by place(); replaces touches().
  void update();
  std::span<const Touch> touches() const { return touches_; }
  // Name of the link that has the shape.
  const std::string& name(std::uint32_t shape) const { return geoms_[shape].name; }

 private:
  struct Body {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d com = Eigen::Vector3d::Zero();
    bool awake = false;
  };
  struct Geom {
    OdeGeomHandle id;
    Surface surface;
    bool box = false;
    std::string name;  // of its link
    int body = -1;
    double radius = 0;                                  // of the sphere about it, m
    Eigen::Vector3d half = Eigen::Vector3d::Zero();     // of a box
    Eigen::Vector3d in_body = Eigen::Vector3d::Zero();  // from the centre of mass
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    // World pose, computed on demand; valid if the round is the current one.
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    std::uint64_t at_round = 0, axes_round = 0;
  };
  // All shapes of one body, or one fixed shape.
  struct Part {
    int body = -1;
    std::size_t first = 0, count = 0;                  // of geoms_
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the sphere, from the centre of mass
    double radius = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // of the sphere, in the world
    bool awake = false;
  };
  // Bounding sphere of a part, packed for the broad phase: most pairs need no more.
  struct Sphere {
    double x = 0, y = 0, z = 0, radius = 0;
  };
  struct Plane {
    std::size_t geom = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0;
  };
  // The face that separated two boxes last time, tried first: temporal coherence. A wrong guess costs time
  // only.
  struct Hint {
    std::size_t a = 0, b = 0;
    int face = 0;
  };

  void add(const RigidLink& link, int robot_link, int body, const Eigen::Isometry3d& pose);
  Geom& add_geom(const CollisionShape& shape, const Eigen::Isometry3d& at);
  void pair_with_robot(std::size_t part, int robot_link);
  void place_parts();
  const Eigen::Vector3d& at(Geom& geom) const;
  const Eigen::Matrix3d& axes(Geom& geom) const;
  dGeomID placed(Geom& geom) const;
  void meet(const Part& a, const Part& b);
  void meet_planes(const Part& part);
  bool parted(std::size_t a, std::size_t b);
  void touch(std::size_t a, std::size_t b);

  std::vector<Touch> touches_;
  std::vector<Body> bodies_;
  std::uint64_t round_ = 0;
  std::vector<Geom> geoms_;
  std::vector<Plane> planes_;
  std::vector<Part> robot_, objects_, fixed_;
  std::vector<Sphere> spheres_;                              // by robot_
  std::vector<int> robot_link_;                              // by robot_
  std::vector<std::pair<std::size_t, std::size_t>> selves_;  // of robot_, that may meet
  Eigen::Vector3d low_, high_;                               // box about the robot's spheres
  bool robot_moves_ = false;
  std::array<Hint, 256> hints_{};
  // exempt_[a * links + b]: links so near in the tree that their shapes may overlap at the joints.
  std::vector<char> exempt_;
  std::size_t robot_links_;
};

}  // namespace kaz::sim
