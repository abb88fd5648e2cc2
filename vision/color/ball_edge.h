// The cone of a ball from the share that it has in each pixel along its edge.
// SPDX-License-Identifier: Apache-2.0
//
// A pixel of the edge is ball by a share s and background by 1 - s: c = s k b + (1 - s) g, b the
// ball's colour beside it, k how much brighter or darker it is lit there, g the background's. What
// of c is across b has no k in it: with n = g - (g . b / b . b) b, s = 1 - n . c / n . g. So shading
// towards the rim does not move the edge, as it does where brightness decides. Where the background
// has the ball's hue or is dark, n = g - b is taken.
//
// A disc of radius R blurred by a Gaussian of sigma has shares near Phi((p - r) / sigma) with p^2 =
// R^2 - sigma^2 (both have the area of the disc); p, sigma and the centre are fitted to all pixels
// along the edge, on the cone as it lies in the picture. That blur counts: of a ball of 2.5 px
// radius it hides a tenth.
#pragma once

#include <bitset>
#include <optional>

#include "vision/color/cone.h"
#include "vision/image/frame.h"

namespace kaz::vision {

// Directions around a cone's axis in which the edge is in sight, each 22.5 degrees.
inline constexpr std::size_t kEdgeSectors = 16;
using EdgeSectors = std::bitset<kEdgeSectors>;

// Turns rays into sectors around an axis.
class SectorFrame {
 public:
  explicit SectorFrame(const Eigen::Vector3d& axis);
  std::size_t sector(const Eigen::Vector3d& ray) const;

 private:
  Eigen::Vector3d x_, y_;
};

struct EdgeFit {
  Cone cone;
  // Share of the variance of the pixels' shares that the fit explains: 1 for a clean edge, near 0 in
  // noise and where what looked like a ball has another outline.
  double explained = 0;
  double sigma_px = 0;  // of the blur
};

// `cone`: to about a pixel. Only pixels in `seen` count. Nothing where contrast or pixels do not
// suffice, or where the fit moves away by more than a third of the radius and a pixel: the cone as
// it was is then better.
std::optional<EdgeFit> fit_edge(const Image& image, const CameraModel& camera, const Cone& cone,
                                const EdgeSectors& seen);

}  // namespace kaz::vision
