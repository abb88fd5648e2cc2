// What vision made of a picture, as pictures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/figure/figure.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/planes/plane_segments.h"

namespace kaz::figure {

// Red at 0.2 m and nearer, green at 0.7 m, blue at 3 m and beyond; black where there is no depth.
vision::Image depth_picture(const vision::DepthImage& depth);
// The floor in green, other segments in other colours, on the picture that they are of.
vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes);

// The same with all segments in one colour, as the paper's figure 6 (A) has them.
vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes,
                            Color color);

// Hue is the direction, strength the length: `longest_px` in full colour. Grey where unknown.
vision::Image flow_picture(const vision::FlowImage& flow, double longest_px);
// Arrows on `left`, the later picture, enlarged by `factor`: from where a point was to where it is, every
// `spacing_px` of it, `stretch` times as long; points that moved less than half a pixel have none.
vision::Image flow_arrows(const vision::Image& left, const vision::FlowImage& flow, int factor,
                          int spacing_px, double stretch);

}  // namespace kaz::figure
