// Finds balls by their color and outline in one picture, in pixels, without a camera model.
// SPDX-License-Identifier: Apache-2.0
//
// Shading, highlights and light reflected by the floor change the color of a ball. A region of the learned
// color therefore often shows only a part of the ball. So the region only gives first outlines (hypotheses).
// Each of them is fitted to edges of the image, found along rays from its center. The color on both sides of
// the outline and the edges on it decide whether the outline is that of a ball.
//
// In the direction t, the radius of an outline is R (1 + c cos 2t + d sin 2t). This is a circle, or an oval:
// away from the axis of a wide-angle lens, the picture of a ball is not round.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vision/color/color.h"
#include "vision/image/frame.h"
#include "vision/image/regions.h"

namespace kaz::vision {

// Evidence that an outline is that of a ball. The first five members are shares, from 0 to 1.
struct OutlineEvidence {
  double support = 0;  // share of the directions that have an edge on the outline
  double arc = 0;  // share of the directions in the longest part of the outline that lies on edges
  // Share of the pixels within that have the ball's color or are highlights, in directions with an edge on
  // the outline. In other directions, an object may hide the ball.
  double filled = 0;
  double isolated = 0;  // share of the pixels around the outline that do not have the ball's color
  double covers = 0;    // share of the region's pixels that are within the outline
  // Brightness of the upper half less that of the lower half, relative to the mean, -0.5 to 0.5. Light mostly
  // comes from above, so the upper half of a ball is brighter; a sign or a face is not.
  double shading = 0;
};

struct BallOutline {
  double center_u = 0, center_v = 0;  // px
  double radius_px = 0;               // mean radius R
  double cos2 = 0, sin2 = 0;          // shape: c and d (see above); hypot(c, d) is at most 0.15
  OutlineEvidence evidence;
  double confidence = 0;  // see outline_confidence()

  // Returns the radius (px) in the direction (cosine, sine).
  double radius_at(double cosine, double sine) const {
    return radius_px * (1 + cos2 * (cosine * cosine - sine * sine) + sin2 * 2 * cosine * sine);
  }
  bool contains(double u, double v, double scale = 1, double margin_px = 0) const;
};

// Probability that an outline is that of a ball: a logistic regression on the evidence and on the logarithm
// of the radius, because chance edges support a small outline more easily. It is 0 if the support is below
// 0.3: such a short part of an outline does not determine a ball. The weights were fitted to the photographs
// of tests/studies/photographs; weights fitted to two of the three places find about as many balls.
double outline_confidence(const OutlineEvidence& evidence, double radius_px);

// Fits an outline to a region of `mask`, the color mask of `image`. Returns the hypothesis with the highest
// confidence, or the first one above 0.9. Returns nullopt if the edges determine none. The radius is more
// than 2 px.
std::optional<BallOutline> fit_outline(const Image& image, const Mask& mask, const Region& region);

struct OutlineOptions {
  ColorRange color = ColorRange::red_ball();
  int min_area = 12;  // minimum number of pixels of a region
  double min_confidence = 0.5;
};

class OutlineFinder {
 public:
  explicit OutlineFinder(const OutlineOptions& options)
      : options_(options), extractor_(options.color) {}

  // Returns the balls in the picture, the highest confidence first. The center of a ball is never within
  // another ball of the result. Only the 48 largest regions are examined. The result is empty if the number
  // of bytes does not match the size of the picture.
  std::vector<BallOutline> find(const Image& image);

  // Returns the color mask of the last find(), for display.
  const Mask& mask() const { return mask_; }

 private:
  OutlineOptions options_;
  ColorExtractor extractor_;
  Mask mask_;
  RegionFinder regions_;
};

}  // namespace kaz::vision
