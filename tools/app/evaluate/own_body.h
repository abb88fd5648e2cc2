// The robot's own shapes as the eyes see them: what its limbs hide.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"

namespace kaz::tools {

// The triangles of which the eyes' pictures are drawn. For the judge alone: a behaviour knows its limbs by
// joint angles, and roughly.
class OwnBody {
 public:
  // Of the scene's shapes those of the frames named in `links`. Error: a shape's file cannot be read.
  static Result<OwnBody> make(const sim::Scene& scene, std::span<const std::string> links);

  // Where the shapes are; `from_world`: the frame of hides().
  void move(const sim::ScenePose& pose, const Eigen::Isometry3d& from_world);
  // Whether a shape is between the eye and what it looks at.
  bool hides(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) const;

 private:
  struct Triangle {
    Eigen::Vector3d corner, to_second, to_third;
  };
  struct Part {
    int frame = 0;
    Eigen::Isometry3d in_frame,
        into;             // of the visual in its frame; from hides()' frame to the visual's
    double radius_m = 0;  // of a sphere around its origin
    std::vector<Triangle> triangles;  // frame of the visual
  };
  std::vector<Part> parts_;
};

}  // namespace kaz::tools
