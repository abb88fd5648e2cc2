// Contact points of a capsule that lies on a face of a box.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Geometry>

#include "sim/body/contact/hull_contact.h"

namespace kaz::sim {

// A capsule in the world frame: all points within `radius` (m) of the segment at + [-1, 1] half_axis.
struct Capsule {
  Eigen::Vector3d at, half_axis;
  double radius = 0;
};

// Finds the two ends of the line in which a capsule lies on a face of a box.
//
// `normal`: unit vector from the box to the capsule, an estimate.
// `points`: both ends, halfway between the surfaces.
// Returns false if the normal is not that of a face, if only one end penetrates, or if the line ends within
// a micrometer.
bool capsule_on_face(const Capsule& capsule, const Polyhedron& box, const Eigen::Vector3d& normal,
                     std::array<DeepPoint, 2>& points);

}  // namespace kaz::sim
