// Draws results of vision: depth, planes and optical flow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/figure/figure.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/planes/plane_segments.h"

namespace kaz::figure {

// Red up to 0.2 m, green at 0.7 m, blue from 3 m on, on a logarithmic scale. Black where depth is unknown.
vision::Image depth_picture(const vision::DepthImage& depth);
// Tints the floor green and other segments in other colors, on their left picture.
vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes);

// The same with all segments in one color, as in figure 6 (A) of the paper.
vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes,
                            Color color);

// Hue shows the direction, saturation the length of the flow, up to `longest_px`. Gray where unknown.
vision::Image flow_picture(const vision::FlowImage& flow, double longest_px);
// Draws arrows on `left`, the later picture, enlarged by `factor`. Each arrow ends at the present position of
// a point and is `stretch` times as long as its flow. Points are `spacing_px` apart in the flow image. Those
// that moved less than 0.5 px have no arrow.
vision::Image flow_arrows(const vision::Image& left, const vision::FlowImage& flow, int factor,
                          int spacing_px, double stretch);

}  // namespace kaz::figure
