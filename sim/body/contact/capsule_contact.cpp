// Contact points of a capsule that lies on a face of a box.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/capsule_contact.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

constexpr double kFaceNormal = 1 - 1e-6;  // cosine
constexpr double kShortLine = 1e-6;       // m

}  // namespace

bool capsule_on_face(const Capsule& capsule, const Polyhedron& box, const Eigen::Vector3d& normal,
                     std::array<DeepPoint, 2>& points) {
  const Eigen::Vector3d own_normal = box.axes.transpose() * normal;
  Eigen::Index face = 0;
  if (own_normal.cwiseAbs().maxCoeff(&face) < kFaceNormal) return false;
  const double sign = own_normal[face] > 0 ? 1 : -1;
  const Eigen::Vector3d middle = box.axes.transpose() * (capsule.at - box.at);
  const Eigen::Vector3d along = box.axes.transpose() * capsule.half_axis;
  // The part of middle + t along, t in [-1, 1], above the face.
  double low = -1, high = 1;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (k == face) continue;
    if (along[k] == 0) {
      if (std::abs(middle[k]) > box.half[k]) return false;
      continue;
    }
    const double a = (-box.half[k] - middle[k]) / along[k],
                 b = (box.half[k] - middle[k]) / along[k];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  if ((high - low) * along.norm() < kShortLine) return false;
  for (std::size_t i = 0; i < 2; ++i) {
    Eigen::Vector3d end = middle + (i == 0 ? low : high) * along;
    const double depth = capsule.radius - (sign * end[face] - box.half[face]);
    if (depth < 0) return false;
    end[face] -= sign * (capsule.radius - depth / 2);
    points[i] = {box.at + box.axes * end, depth};
  }
  return true;
}

}  // namespace kaz::sim
