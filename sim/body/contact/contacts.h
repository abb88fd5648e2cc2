// Collision detection: finds all contact points between robot, objects and fixed shapes.
// SPDX-License-Identifier: Apache-2.0
//
// Broad phase: each link or object has one bounding sphere. A pair of two spheres, or of a sphere and a
// plane, is skipped if the distance is too large for a contact. No tree or grid is needed, because a scene
// has few shapes. The pairs of robot links that can collide are listed in advance. The narrow phase uses
// ODE's colliders, and hull_contact.h for the faces of hulls. For two boxes, this class first tests whether
// a face normal of either box is a separating axis (Gottschalk et al., SIGGRAPH 1996). If a separating axis
// is found, the boxes do not touch, and ODE is not called. Pairs of fixed or sleeping bodies are skipped.
//
// A Contacts object is working memory. Only hints are kept from step to step; hints save time but do not
// change results. Therefore each thread has one Contacts object for all its worlds, and the object stays in
// the processor's cache.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/body/contact/contact_model.h"
#include "sim/body/contact/hull_contact.h"
#include "sim/body/contact/ode_handles.h"

namespace kaz::sim {

// A contact point between two bodies a and b. Vectors are in the world frame, lengths in m.
struct Touch {
  // -1: the shape is fixed; at most one of the two bodies is -1.
  int body_a = -1, body_b = -1;
  std::uint32_t shape_a = 0, shape_b = 0;  // indices into ContactModel::geoms()
  // `normal` is a unit vector in the direction of the force that body b exerts on body a.
  Eigen::Vector3d at, normal;
  double depth = 0;  // depth of penetration
  Surface surface;   // contact parameters of the pair of surfaces
};

class Contacts {
 public:
  // Returns the instance of the calling thread.
  static Contacts& of_this_thread();

  // Begins a search among the shapes of `model`, which must exist until the next begin().
  void begin(const ContactModel& model);
  // Sets the pose of a body in the world frame. `axes` are the axes of the body's link, `com` is the center
  // of mass. Call for each body that can move. Sleeping bodies collide only with bodies that are awake.
  void place(int body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& com, bool awake) {
    bodies_[static_cast<std::size_t>(body)] = {axes, com, awake};
  }
  // Finds the contacts at the poses set by place() and replaces touches().
  void update();
  // Contact points that update() found. The span is valid until the next begin() in this thread.
  std::span<const Touch> touches() const { return touches_; }

 private:
  using Geom = ContactModel::Geom;
  struct Body {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d com = Eigen::Vector3d::Zero();
    bool awake = false;
  };
  // World pose of a moving geom, computed on demand. `at` is up to date if at_round equals round_. `axes` is
  // up to date if axes_round equals round_.
  struct Pose {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    std::uint64_t at_round = 0, axes_round = 0;
  };
  // A part of the model and its bounding sphere in the world.
  struct Part {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double radius = 0;
    std::size_t first = 0, count = 0;  // range of indices into ContactModel::geoms()
    bool awake = false;
  };
  // Bounding sphere of a part, packed for fast access in the broad phase.
  struct Sphere {
    double x = 0, y = 0, z = 0, radius = 0;
  };
  // A face normal that was a separating axis of the boxes `a` and `b`. `face` is 0..2 for a face normal of
  // box `a`, and 3..5 for a face normal of box `b`. The next test of these two boxes tries this face
  // normal first (temporal coherence). A wrong hint only costs time.
  struct Hint {
    std::uint32_t a = 0, b = 0;
    int face = 0;
  };
  // One ODE geom of each kind of shape. Before each test, the geom receives the size and pose of the tested
  // shape.
  using OdeShapes = std::array<OdeGeomHandle, 6>;

  Contacts();
  void place_parts(std::span<const ContactModel::Part> from, std::vector<Part>& to);
  const Eigen::Vector3d& at(std::size_t geom);
  const Eigen::Matrix3d& axes(std::size_t geom);
  dGeomID placed(const OdeShapes& shapes, std::size_t geom);
  void meet(const Part& a, const Part& b);
  void meet_robot(const Part& other);
  void meet_planes(const Part& part);
  bool parted(std::size_t a, std::size_t b);
  Touch contact_of(std::size_t a, std::size_t b) const;
  void rest(std::size_t hull, const ContactModel::Plane& plane);
  void touch(std::size_t a, std::size_t b);
  bool touch_faces(std::size_t a, std::size_t b, double depth, Eigen::Vector3d normal);
  bool touch_lying(std::size_t capsule, std::size_t box, double sign, Touch touch);
  void add_spanning(Touch touch);

  const ContactModel* model_ = nullptr;
  std::vector<Touch> touches_;
  std::vector<Body> bodies_;
  std::uint64_t round_ = 0;  // number of calls of begin() in this thread, summed over all worlds
  std::vector<Pose> poses_;  // indexed by geom
  std::vector<Part> robot_, objects_, fixed_;
  std::vector<Sphere> spheres_;  // bounding spheres of the elements of robot_
  Eigen::Vector3d low_, high_;   // bounding box of the robot's bounding spheres
  bool robot_moves_ = false;
  std::array<Hint, 256> hints_{};
  OdeShapes of_a_, of_b_;
  std::vector<DeepPoint> deep_;  // corners of a contact area
};

}  // namespace kaz::sim
