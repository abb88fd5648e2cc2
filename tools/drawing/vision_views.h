// Draws results of vision: depth, planes and optical flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/drawing/figure.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/planes/plane_segments.h"

namespace kaz::figure {

// Draws depth on a logarithmic scale: red up to 0.2 m, green at 0.7 m, blue from 3 m on. Pixels of unknown
// depth are black.
vision::Image depth_picture(const vision::DepthImage& depth);
// Tints the segments on the left picture of their pair: the floor green, other segments in other colors.
vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes);

// Hue shows the direction of the flow. Saturation shows the length of the flow, up to `longest_px`. Pixels of
// unknown flow are gray.
vision::Image flow_picture(const vision::FlowImage& flow, double longest_px);

}  // namespace kaz::figure
