// Makes the camera model and the pose of an observer's camera. The poses of the robot's cameras come from
// links of the robot's URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/render/renderer.h"

namespace kaz::sim {

// Makes a pinhole camera with square pixels, without a baseline. The principal point is in the center of the
// picture. Unit of the sizes: px.
vision::CameraModel camera_of_view(int width, int height, double horizontal_rad);

// Returns the pose of a camera's optical frame. The origin of the frame is the point `eye`, and the z axis
// points to the point `target`. In the picture, the frame's x axis points to the right, and the frame's y
// axis points down. The world's z axis points up in the picture. `eye` must not be exactly above or below
// `target`. All points are in the world frame, m.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace kaz::sim
