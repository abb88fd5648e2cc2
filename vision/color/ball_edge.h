// Fits a ball's viewing cone with subpixel precision to the mixed pixels along the ball's edge.
// SPDX-License-Identifier: Apache-2.0
//
// Mixing model: a pixel of the edge has the color c = s k b + (1 - s) g. Here s is the coverage: the share of
// the pixel that the ball covers. The ball's color near the pixel is b, the ball's shading factor at the
// pixel is k, and the background color is g. The component of c orthogonal to b does not depend on k. The
// component of g orthogonal to b is n = g - ((g . b) / (b . b)) b. The coverage is s = 1 - (n . c) / (n . g).
// So shading towards the rim does not bias the edge. With a threshold on brightness, shading would bias the
// edge. If the background has the ball's hue or is dark, n = g - b is used.
//
// Edge model: a disk of radius R is blurred by a Gaussian of standard deviation sigma. At the distance r from
// the center, the coverage is approximately Phi((p - r) / sigma), where Phi is the cumulative normal
// distribution. The blur does not change the sum of the coverage over all pixels, which is the area of the
// disk. The area of the disk is pi R^2. In the approximation, the sum of the coverage is pi (p^2 + sigma^2).
// Therefore p^2 + sigma^2 = R^2. The fit determines p, sigma and the center from all pixels along the outline
// of the cone in the image. Blur is important for small balls. Example: if R is 2.5 px and sigma is 1.1 px, p
// is 10 % smaller than R.
//
// Units: px in the image, rad for the cone. Frame: optical, rays with z = 1.
#pragma once

#include <bitset>
#include <optional>

#include "vision/color/cone.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// The circle around a cone's axis is divided into sectors of 22.5 degrees. An EdgeSectors value is the set of
// sectors in which the edge is visible.
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
  // Coefficient of determination R^2 of the coverage: 1 for a clean edge, near 0 for noise or other shapes.
  double explained = 0;
  double sigma_px = 0;  // standard deviation of the blur
};

// Fits the cone, starting at `cone`, which must be accurate to about a pixel. Uses only pixels in the sectors
// `seen`. Returns nullopt if the contrast is too low or there are too few pixels. Also returns nullopt if the
// fit changes the half angle or the direction of the axis by more than a limit. The limit is the larger of
// two angles: 0.35 times the half angle of `cone`, and the angle that corresponds to 1.2 px. After a change
// beyond the limit, the fitted cone is less accurate than `cone`.
std::optional<EdgeFit> fit_edge(const Image& image, const CameraModel& camera, const Cone& cone,
                                const EdgeSectors& seen);

}  // namespace kaz::vision
