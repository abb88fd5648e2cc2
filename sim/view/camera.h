// The robot's two eyes: where the lenses sit in the head, and what they see.
// SPDX-License-Identifier: Apache-2.0
//
// The paper names the cameras (CK-200 with wide conversion) but neither their view nor their place:
// both are assumptions of this project. The axes of the eyes are parallel, so pairs are rectified
// as they come.
#pragma once

#include "sim/view/renderer.h"

namespace kaz::sim {

struct EyeRig {
  // Lens centres in the frame of the head link (x forward, y left, z up), m.
  Eigen::Vector3d left_lens{0.030, 0.020, 0.022};
  Eigen::Vector3d right_lens{0.030, -0.020, 0.022};
  double horizontal_view_rad = 80.0 * 3.14159265358979323846 / 180.0;

  double baseline_m() const { return (left_lens - right_lens).norm(); }
  Eigen::Isometry3d head_from_left_optical() const;
  Eigen::Isometry3d head_from_right_optical() const;
};

// An optical frame (x right, y down, z forward) at `eye` that looks at `target`, with world z up.
// `eye` must not stand straight above or below `target`.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace kaz::sim
