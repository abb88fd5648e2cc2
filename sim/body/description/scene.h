// Visual scene: shapes, materials and poses. sim/body builds the scene, sim/render draws it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace kaz::sim {

struct ConvexHull;  // convex_hull.h

struct Rgb {
  float r = 0.8f, g = 0.8f, b = 0.8f;  // 0..1, as in URDF and SDF
};

struct Shape {
  enum class Kind { box, cylinder, sphere, capsule, plane, hull, mesh };
  Kind kind = Kind::box;
  // Dimensions in m. Box: full lengths along x, y, z. Cylinder: radius, length along z. Capsule: radius,
  // length along z without the caps. Sphere: radius. Plane: lengths along x and y; the normal of a plane is
  // z. Mesh: scale factors without unit. Hull: not used.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  std::shared_ptr<const ConvexHull> hull = nullptr;  // hulls only, which occur only in collisions
  std::string mesh_path;  // meshes only: absolute path of an OBJ or STL file
};

struct Visual {
  std::string name;  // "link/visual", unique
  int frame = 0;     // index into ScenePose::frames
  Eigen::Isometry3d in_frame = Eigen::Isometry3d::Identity();
  Shape shape;
  Rgb color;
  // Procedural texture based on `color`: "checker", "wood", "carpet", or "" for none.
  std::string texture;
};

// The light of a scene: a directional key light and the ambient light.
struct Light {
  // Vector from the scene toward the lamp. z must be above 0. The length of the vector has no effect.
  Eigen::Vector3d to_key{0.55, -0.50, 1.0};
  // `key` is a factor for the brightness of the key light. `shaded` is a factor for the brightness of the
  // ambient light.
  double key = 1, shaded = 1;
};

// The part of a scene that is constant while the world runs.
struct Scene {
  std::vector<Visual> visuals;
  // Names of the frames. Element 0 is the world. The robot links follow, and then the movable objects.
  std::vector<std::string> frames;
  Light light;
  // Pose of the robot at the start, in the world frame. The origin of this pose is the point between the
  // soles; the x axis points forward.
  Eigen::Isometry3d robot_start = Eigen::Isometry3d::Identity();
};

// Poses of all frames of a scene at one time.
struct ScenePose {
  std::vector<Eigen::Isometry3d> frames;
};

}  // namespace kaz::sim
