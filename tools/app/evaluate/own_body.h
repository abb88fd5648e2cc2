// Shapes of the robot as its eyes see them, to find what its limbs hide.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"

namespace kaz::tools {

// Contains the triangles of which the eyes' pictures are drawn. Only the judge uses it. A behavior estimates
// its limbs roughly, from joint angles.
class OwnBody {
 public:
  // Takes the scene's shapes of the frames in `links`. Fails if a shape's file cannot be read.
  static Result<OwnBody> make(const sim::Scene& scene, std::span<const std::string> links);

  // Moves the shapes to their poses. `from_world`: transform to the frame of hides().
  void move(const sim::ScenePose& pose, const Eigen::Isometry3d& from_world);
  // Whether a shape is between the eye and the point `at`.
  bool hides(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) const;

 private:
  struct Triangle {
    Eigen::Vector3d corner, to_second, to_third;
  };
  struct Part {
    int frame = 0;
    // in_frame: pose of the visual in its frame. into: from the frame of hides() to the visual's.
    Eigen::Isometry3d in_frame, into;
    double radius_m = 0;              // radius of a sphere around its origin
    std::vector<Triangle> triangles;  // in the frame of the visual
  };
  std::vector<Part> parts_;
};

}  // namespace kaz::tools
