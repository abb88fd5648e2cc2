// Subpixel fit of a ball's viewing cone to the mixed pixels along its edge.
// SPDX-License-Identifier: Apache-2.0
//
// Mixing model: a pixel of the edge has the colour c = s k b + (1 - s) g, where s is the ball's coverage, b
// the ball's colour nearby, k its local shading factor and g the background's colour. The component of c
// orthogonal to b does not depend on k: with n = g - (g . b / b . b) b, s = 1 - n . c / n . g. So shading
// towards the rim does not bias the edge, unlike thresholds on brightness. If the background has the ball's
// hue or is dark, n = g - b is used.
//
// Edge model: a disc of radius R blurred by a Gaussian of standard deviation sigma has the coverage
// Phi((p - r) / sigma), approximately, with p^2 = R^2 - sigma^2 (equal areas); r is the distance from the
// centre, Phi the normal distribution. p, sigma and the centre are fitted to all pixels along the edge, on
// the cone's outline in the image. The blur matters: for a ball of 2.5 px radius p is a tenth less than R.
//
// Units: px of the image, rad of the cone. Frame: optical, rays with z = 1.
#pragma once

#include <bitset>
#include <optional>

#include "vision/color/cone.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// Sectors of 22.5 degrees around a cone's axis in which the edge is visible.
inline constexpr std::size_t kEdgeSectors = 16;
using EdgeSectors = std::bitset<kEdgeSectors>;

// Sector of a ray around an axis.
class SectorFrame {
 public:
  explicit SectorFrame(const Eigen::Vector3d& axis);
  std::size_t sector(const Eigen::Vector3d& ray) const;

 private:
  Eigen::Vector3d x_, y_;
};

struct EdgeFit {
  Cone cone;
  // Coefficient of determination R^2 of the coverage: 1 for a clean edge, near 0 in noise or for an object
  // with another outline.
  double explained = 0;
  double sigma_px = 0;  // of the blur
};

// `cone`: initial estimate, accurate to about a pixel. Uses only pixels in the sectors `seen`. Nothing if
// contrast or the number of pixels is too small, or if the fit moves by more than about a third of the radius
// (at least 1.2 px): the initial estimate is then better.
std::optional<EdgeFit> fit_edge(const Image& image, const CameraModel& camera, const Cone& cone,
                                const EdgeSectors& seen);

}  // namespace kaz::vision
