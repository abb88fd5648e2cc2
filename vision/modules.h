// The modules of vision that come with it, for a pipeline.
// SPDX-License-Identifier: Apache-2.0
//
// | module | result | needs |
// |---|---|---|
// | color | BallObservation: the ball by its colour, in the left picture | |
// | depth | DepthImage | |
// | planes | PlaneSegments | depth |
//
// Latencies are those that the design declares for lockstep (section 3), from measured runs.
#pragma once

#include <memory>

#include "vision/ball.h"
#include "vision/depth.h"
#include "vision/module.h"
#include "vision/plane_segments.h"

namespace kaz::vision {

inline constexpr Time kColorLatency = std::chrono::milliseconds(5);
inline constexpr Time kDepthLatency = std::chrono::milliseconds(20);
inline constexpr Time kPlanesLatency = std::chrono::milliseconds(30);

std::unique_ptr<Module> make_color_module(const BallOptions& options, Time latency = kColorLatency);
std::unique_ptr<Module> make_depth_module(const DepthOptions& options,
                                          Time latency = kDepthLatency);
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options,
                                           Time latency = kPlanesLatency);

}  // namespace kaz::vision
