// Finds a ball of known radius and colour in one picture: direction and distance.
// SPDX-License-Identifier: Apache-2.0
//
// The outline of a sphere is a circle on the sphere of directions (a cone of rays), though an
// ellipse in a wide picture. With unit rays r to points of the outline, axis n and half angle
// alpha, n . r = cos(alpha) for all of them: a least-squares fit of three numbers, exact in
// perspective, that needs only part of the outline, so that a ball cut off at the edge of the
// picture is measured as well. Distance of the centre = radius / sin(alpha).
#pragma once

#include <optional>

#include <Eigen/Core>

#include "vision/color/color.h"
#include "vision/image/regions.h"

namespace kaz::vision {

struct BallOptions {
  double radius_m = 0.020;
  ColorRange color = ColorRange::red_ball();
  int min_area = 12;  // pixels; smaller regions are noise
  // Less is not reported as found. Highest threshold at which the shares of missed, wrong and false
  // finds, of whole, cut, half hidden balls and of red and orange clutter, sum up to within a standard
  // error of the minimum (docs/explanation/vision.md).
  double min_confidence = 0.68;
};

struct BallObservation {
  FrameInfo info;      // of the picture in which it was detected
  bool found = false;  // if false, the other members are undefined
  // px, projection of the ball's centre, which is not the middle of the ellipse.
  double center_u = 0, center_v = 0;
  double radius_px = 0;  // px, geometric mean of the outline's half axes
  // Unit vector to the ball's centre, optical frame.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double distance_m = 0;  // lens to centre
  // 0..1: geometric mean of the share of the region's outline that lies on the cone, the share of
  // the cone that the region fills, and how well the cone explains the mixed colours along its edge
  // (ball_edge.h; a quarter where they say nothing); less where under a third of the circumference
  // was seen, and where motion blur is as wide as the radius: the distance is open then.
  double confidence = 0;
  // Why the picture could not be looked at (camera gone, no pixels, wrong size): `found` is false
  // then.
  std::optional<Error> error;

  Eigen::Vector3d position() const { return direction * distance_m; }  // m, optical frame
};

class BallDetector {
 public:
  explicit BallDetector(const BallOptions& options)
      : options_(options), extractor_(options.color) {}

  // The camera's width and height must be those of the image, its focal lengths positive;
  // otherwise, and for an empty image, the answer carries an error. Frame information is copied
  // into the answer.
  BallObservation detect(const Image& image, const FrameInfo& info);

  // What the last call to detect() saw, for pictures.
  const Mask& mask() const { return mask_; }

 private:
  BallOptions options_;
  ColorExtractor extractor_;
  Mask mask_;
  RegionFinder regions_;
};

}  // namespace kaz::vision
