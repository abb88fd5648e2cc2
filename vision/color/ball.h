// Finds a ball of known radius and color in one picture, and computes direction and distance of the ball.
// SPDX-License-Identifier: Apache-2.0
//
// The rays to the outline of a ball form a circular cone, but the outline in the picture is an ellipse. Unit
// rays r to the outline satisfy n . r = cos(alpha), where n is the axis and alpha the half angle of the cone.
// The axis n and the half angle alpha are fitted by least squares. Because the fit uses rays, perspective
// causes no error. The fit needs only part of the outline, so a ball that is cut off at the edge of the
// picture can also be measured. The distance to the center of the ball is radius / sin(alpha).
#pragma once

#include <optional>

#include <Eigen/Core>

#include "vision/color/color.h"
#include "vision/image/regions.h"

namespace kaz::vision {

struct BallOptions {
  double radius_m = 0.020;
  ColorRange color = ColorRange::red_ball();
  int min_area = 12;  // minimum number of pixels; smaller regions are noise
  // Balls with a confidence below this value are not reported. The default was chosen on test pictures of
  // whole, cut off and half hidden balls among red and orange clutter. For each threshold, the mistakes of
  // the detector on these pictures were counted. Among the thresholds with nearly the fewest mistakes (within
  // one standard error), the default is the highest threshold.
  double min_confidence = 0.68;
};

struct BallObservation {
  FrameInfo info;      // frame information of the searched picture
  bool found = false;  // if false, the members below are undefined, except `error`
  // Projection of the ball's center, px; not the middle of the ellipse.
  double center_u = 0, center_v = 0;
  double radius_px = 0;  // geometric mean of the outline's half axes, px
  // Unit vector to the ball's center, optical frame.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double distance_m = 0;  // distance from the lens to the ball's center
  // Confidence of the detection, 0 to 1: geometric mean of three factors.
  // - The share of the region's outline that lies on the cone.
  // - The ratio of the region's area to the area of the cone in the picture.
  // - The quality of the edge's fit (EdgeFit::explained, ball_edge.h). If the edge cannot be fitted, this
  //   factor is 0.25.
  // The confidence is reduced if less than a third of the circumference is visible. The confidence is also
  // reduced if motion blur exceeds a sixth of the radius, because the distance is then uncertain.
  double confidence = 0;
  // Set if the picture could not be searched: the camera is lost, or the picture has no pixels or a wrong
  // size. If `error` is set, `found` is false.
  std::optional<Error> error;

  Eigen::Vector3d position() const { return direction * distance_m; }  // m, optical frame
};

class BallFinder {
 public:
  explicit BallFinder(const BallOptions& options) : options_(options), extractor_(options.color) {}

  // Searches one picture and copies `info` into the result. The result is the candidate with the highest
  // confidence. If the posture is known, candidates whose size fits a ball on the floor are preferred to all
  // other candidates. The result has an error if the image is empty or has another size than the camera
  // model, or a focal length is not positive.
  BallObservation detect(const Image& image, const FrameInfo& info);

  // Returns the color mask of the last detect(), for display.
  const Mask& mask() const { return mask_; }

 private:
  BallOptions options_;
  ColorExtractor extractor_;
  Mask mask_;
  RegionFinder regions_;
};

}  // namespace kaz::vision
