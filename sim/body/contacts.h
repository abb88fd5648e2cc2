// Finds what touches what, and makes the solver's contact rows of it.
// SPDX-License-Identifier: Apache-2.0
//
// So few shapes need no tree or grid: each link or object is one sphere, and few multiplications
// tell that two spheres, or a sphere and a plane, are apart. Which parts of the robot may meet is
// known at the start. What is left goes to ODE's colliders, two boxes only after the faces of both
// have been tried as planes between them. Pairs of which neither can move are never looked at.
#pragma once

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "sim/body/ode_handles.h"
#include "sim/body/rigid_link.h"
#include "sim/body/robot_model.h"
#include "sim/body/world.h"

namespace kaz::sim {

class Contacts {
 public:
  Contacts(dWorldID world, const RobotModel& robot);

  // Shapes of one link. `body` null: fixed in the world, then `pose` is the link's; else shapes
  // hang on the body, whose frame has the link's axes and its origin at `com`.
  void add_robot_link(const RigidLink& link, int robot_link, dBodyID body,
                      const Eigen::Isometry3d& pose);
  void add_object(const RigidLink& link, dBodyID body, const Eigen::Isometry3d& pose);

  // Replaces the rows of the last step.
  void update();
  // Rows that update() made: points of contact.
  int count() const { return count_; }

  // Keeps the forces of the rows that are made from now on.
  void watch(bool on) { watch_ = on; }
  std::vector<ContactPoint> watched() const;

 private:
  struct Geom {
    OdeGeomHandle id;
    Surface surface;
    bool box = false;
    std::string name;                                // of its link
    double radius = 0;                               // of the sphere about it, m
    Eigen::Vector3d half = Eigen::Vector3d::Zero();  // of a box
  };
  // All shapes of one body, or one fixed shape.
  struct Part {
    dBodyID body = nullptr;
    std::size_t first = 0, count = 0;                  // of geoms_
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the sphere, in the body's frame
    double radius = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();  // of the sphere, in the world
    bool awake = false;
  };
  struct Plane {
    std::size_t geom = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0;
  };
  // A face that lay between two boxes when they were last looked at: most likely it still does. A
  // wrong guess costs time alone.
  struct Hint {
    std::size_t a = 0, b = 0;
    int face = 0;
  };

  struct Watched {
    std::size_t a, b;  // of geoms_
    Eigen::Vector3d at;
    bool turned;  // the feedback is b's
    dJointFeedback feedback;
  };

  void add(const RigidLink& link, int robot_link, dBodyID body, const Eigen::Isometry3d& pose);
  Geom& add_geom(const CollisionShape& shape, const Eigen::Isometry3d& at);
  void pair_with_robot(std::size_t part, int robot_link);
  void place_parts();
  void meet(const Part& a, const Part& b);
  void meet_planes(const Part& part);
  bool parted(std::size_t a, std::size_t b);
  void touch(std::size_t a, std::size_t b);

  dWorldID world_;
  OdeJointGroupHandle rows_;
  int count_ = 0;
  bool watch_ = false;
  std::deque<Watched> watched_;  // ODE keeps pointers to the feedbacks
  std::vector<Geom> geoms_;
  std::vector<Plane> planes_;
  std::vector<Part> robot_, objects_, fixed_;
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
