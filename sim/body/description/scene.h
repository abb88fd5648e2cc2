// Visual scene: shapes, materials and poses. sim/body builds the scene, sim/view draws it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace kaz::sim {

struct Rgb {
  float r = 0.8f, g = 0.8f, b = 0.8f;  // 0..1, as in URDF and SDF
};

struct Shape {
  enum class Kind { box, cylinder, sphere, capsule, plane, mesh };
  Kind kind = Kind::box;
  // Meters. Box: full lengths along x, y, z. Cylinder: radius, length along z. Capsule: radius, length along
  // z without the caps. Sphere: radius. Plane: lengths along x, y; its normal is z. Mesh: scale factors.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  std::string mesh_path;  // meshes only: absolute path of an OBJ or STL file
};

struct Visual {
  std::string name;  // "link/visual", unique
  int frame = 0;     // index into ScenePose::frames
  Eigen::Isometry3d in_frame = Eigen::Isometry3d::Identity();
  Shape shape;
  Rgb color;
  std::string texture;  // "", "checker", "wood", "carpet": procedural texture, based on `color`
};

// A directional key light and the ambient light.
struct Light {
  Eigen::Vector3d to_key{0.55, -0.50, 1.0};  // direction to the lamp, any length, z > 0
  double key = 1,
         shaded = 1;  // factors on the brightness of key light and ambient light
};

// Constant while the world runs.
struct Scene {
  std::vector<Visual> visuals;
  std::vector<std::string> frames;  // 0: the world, then robot links and movable objects
  Light light;
  // Start pose of the robot in the world frame: the origin is the point between the soles, x is forward.
  Eigen::Isometry3d robot_start = Eigen::Isometry3d::Identity();
};

// World pose of each frame at one time.
struct ScenePose {
  std::vector<Eigen::Isometry3d> frames;
};

}  // namespace kaz::sim
