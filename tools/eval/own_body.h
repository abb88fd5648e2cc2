// Shapes of the robot that the robot's eyes can see, to find the points that the robot's limbs hide.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"

namespace kaz::tools {

// Contains the same triangles from which the eyes' pictures are drawn. Only the judge uses this class. A
// behavior estimates the positions of the robot's limbs roughly, from joint angles.
class OwnBody {
 public:
  // Copies the shapes of the scene's frames that `links` lists. Fails if the file of a shape cannot be read.
  static Result<OwnBody> make(const sim::Scene& scene, std::span<const std::string> links);

  // Moves the shapes to their poses in `pose`. `from_world`: transform from the world to the frame of
  // hides().
  void move(const sim::ScenePose& pose, const Eigen::Isometry3d& from_world);
  // Returns whether a shape is between the eye and the point `at`.
  bool hides(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) const;

 private:
  struct Triangle {
    Eigen::Vector3d corner, to_second, to_third;
  };
  struct Part {
    int frame = 0;
    // in_frame: pose of the visual in its frame. into: transform from the frame of hides() to the frame of
    // the visual.
    Eigen::Isometry3d in_frame, into;
    // Radius of a sphere around the visual's origin that contains all triangles.
    double radius_m = 0;
    std::vector<Triangle> triangles;  // in the frame of the visual
  };
  std::vector<Part> parts_;
};

}  // namespace kaz::tools
