// Collision detection: finds all contact points between robot, objects and fixed shapes.
// SPDX-License-Identifier: Apache-2.0
//
// Broad phase: a scene has few shapes, so there is no tree or grid. Each link or object has one bounding
// sphere. Two spheres, or a sphere and a plane, are skipped if they are too far apart. The pairs of robot
// links that may collide are listed in advance. Narrow phase: ODE's colliders. Two boxes are passed to ODE
// only if no face normal of either box is a separating axis (Gottschalk et al., SIGGRAPH 1996). Pairs of
// fixed or sleeping bodies are skipped.
//
// A Contacts object is working memory. Only hints are kept from step to step; hints save time but do not
// change results. So each thread has one Contacts object for all its worlds, and the object stays in the
// processor's cache.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/body/contact/contact_model.h"
#include "sim/body/contact/ode_handles.h"

namespace kaz::sim {

// Contact point. World frame, m.
struct Touch {
  int body_a = -1, body_b = -1;            // -1: fixed; never both
  std::uint32_t shape_a = 0, shape_b = 0;  // indices into ContactModel::geoms()
  // `normal` is a unit vector in the direction of the force of b on a.
  Eigen::Vector3d at, normal;
  double depth = 0;  // penetration
  Surface surface;   // combined parameters of the pair
};

class Contacts {
 public:
  // Returns the instance of the calling thread.
  static Contacts& of_this_thread();

  // Begins a search among the shapes of `model`, which must exist until the next begin().
  void begin(const ContactModel& model);
  // Sets the pose of a body in the world frame: axes of the body's link, and center of mass. Call for each
  // body that can move. Sleeping bodies collide only with bodies that are awake.
  void place(int body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& com, bool awake) {
    bodies_[static_cast<std::size_t>(body)] = {axes, com, awake};
  }
  // Finds the contacts at the poses set by place() and replaces touches().
  void update();
  // Valid until the next begin() in this thread.
  std::span<const Touch> touches() const { return touches_; }

 private:
  using Geom = ContactModel::Geom;
  struct Body {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d com = Eigen::Vector3d::Zero();
    bool awake = false;
  };
  // World pose of a moving geom, computed on demand. Valid if the member `round` equals round_.
  struct Pose {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    std::uint64_t at_round = 0, axes_round = 0;
  };
  // A part of the model and its bounding sphere in the world.
  struct Part {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double radius = 0;
    std::size_t first = 0, count = 0;  // range of geoms
    bool awake = false;
  };
  // Bounding sphere of a part, packed for the broad phase, which rejects most pairs.
  struct Sphere {
    double x = 0, y = 0, z = 0, radius = 0;
  };
  // The face that separated two boxes last time. This face is tried first (temporal coherence). A wrong hint
  // only costs time.
  struct Hint {
    std::uint32_t a = 0, b = 0;
    int face = 0;
  };
  // One ODE geom of each kind. Each test sets the geom to the size and pose of the tested shape.
  using OdeShapes = std::array<OdeGeomHandle, 5>;

  Contacts();
  void place_parts(std::span<const ContactModel::Part> from, std::vector<Part>& to);
  const Eigen::Vector3d& at(std::size_t geom);
  const Eigen::Matrix3d& axes(std::size_t geom);
  dGeomID placed(const OdeShapes& shapes, std::size_t geom);
  void meet(const Part& a, const Part& b);
  void meet_robot(const Part& other);
  void meet_planes(const Part& part);
  bool parted(std::size_t a, std::size_t b);
  void touch(std::size_t a, std::size_t b);

  const ContactModel* model_ = nullptr;
  std::vector<Touch> touches_;
  std::vector<Body> bodies_;
  std::uint64_t round_ = 0;  // number of calls of begin(), for all worlds of the thread
  std::vector<Pose> poses_;  // by geom
  std::vector<Part> robot_, objects_, fixed_;
  std::vector<Sphere> spheres_;  // by index into robot_
  Eigen::Vector3d low_, high_;   // bounding box of the robot's spheres
  bool robot_moves_ = false;
  std::array<Hint, 256> hints_{};
  OdeShapes of_a_, of_b_;
};

}  // namespace kaz::sim
