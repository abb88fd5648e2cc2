// Subpixel fit of a ball's viewing cone to the mixed pixels along its edge.
// SPDX-License-Identifier: Apache-2.0
//
// Mixing model: a pixel of the edge has the color c = s k b + (1 - s) g. Here s is the ball's coverage, b the
// ball's color nearby, k its local shading factor and g the background color. The component of c orthogonal
// to b does not depend on k. With n = g - (g . b / b . b) b, the coverage is s = 1 - n . c / n . g. So
// shading towards the rim does not bias the edge, unlike thresholds on brightness. If the background has the
// ball's hue or is dark, n = g - b is used.
//
// Edge model: a disk of radius R is blurred by a Gaussian of standard deviation sigma. At the distance r from
// the center its coverage is approximately Phi((p - r) / sigma), where Phi is the normal distribution. Equal
// areas give p^2 = R^2 - sigma^2. The fit determines p, sigma and the center from all pixels along the edge,
// on the outline of the cone in the image. The blur matters: for a ball of 2.5 px radius, p is a tenth less
// than R.
//
// Units: px in the image, rad for the cone. Frame: optical, rays with z = 1.
#pragma once

#include <bitset>
#include <optional>

#include "vision/color/cone.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// Set of visible sectors of 22.5 degrees around a cone's axis.
inline constexpr std::size_t kEdgeSectors = 16;
using EdgeSectors = std::bitset<kEdgeSectors>;

// Computes the sector of a ray around an axis.
class SectorFrame {
 public:
  explicit SectorFrame(const Eigen::Vector3d& axis);
  std::size_t sector(const Eigen::Vector3d& ray) const;

 private:
  Eigen::Vector3d x_, y_;
};

struct EdgeFit {
  Cone cone;
  // Coefficient of determination R^2 of the coverage: 1 for a clean edge, near 0 in noise or for another
  // outline.
  double explained = 0;
  double sigma_px = 0;  // standard deviation of the blur
};

// Fits the cone, starting at `cone`, which must be accurate to about a pixel. Uses only pixels in the sectors
// `seen`. Returns nullopt if contrast or the number of pixels is too small. It also does if the fit moves by
// more than about a third of the radius (at least 1.2 px). The initial estimate is then better.
std::optional<EdgeFit> fit_edge(const Image& image, const CameraModel& camera, const Cone& cone,
                                const EdgeSectors& seen);

}  // namespace kaz::vision
