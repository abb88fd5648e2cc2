// The modules of vision that come with it, for a pipeline.
// SPDX-License-Identifier: Apache-2.0
//
// | module | result | needs |
// |---|---|---|
// | color | BallObservation: the ball by its colour, in the left picture | |
// | depth | DepthImage | |
// | flow | FlowImage: of the left picture since the frame before; its width is 0 where there is none | |
// | planes | PlaneSegments | depth |
// | floor | PlaneSegments with the floor's edges as the left picture has them | planes |
// | moving | MovingRegions: what moves by itself; 0 cells across where there is no flow | flow, depth |
//
// Latencies are those that the design declares for lockstep (section 3), from measured runs.
#pragma once

#include <memory>

#include "vision/color/ball.h"
#include "vision/depth/depth.h"
#include "vision/flow/flow.h"
#include "vision/flow/independent_motion.h"
#include "vision/pipeline/module.h"
#include "vision/planes/floor_edges.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision {

inline constexpr Time kColorLatency = std::chrono::milliseconds(5);
inline constexpr Time kDepthLatency = std::chrono::milliseconds(20);
inline constexpr Time kFlowLatency = std::chrono::milliseconds(10);
inline constexpr Time kPlanesLatency = std::chrono::milliseconds(30);
inline constexpr Time kMovingLatency = std::chrono::milliseconds(10);
inline constexpr Time kFloorLatency = std::chrono::milliseconds(10);

std::unique_ptr<Module> make_color_module(const BallOptions& options, Time latency = kColorLatency);
std::unique_ptr<Module> make_depth_module(const DepthOptions& options,
                                          Time latency = kDepthLatency);
// No flow for the first frame, where the camera's clock stepped back, and where the frame before is
// longer ago than `longest`.
std::unique_ptr<Module> make_flow_module(const FlowOptions& options, Time latency = kFlowLatency,
                                         Time longest = std::chrono::milliseconds(200));
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options,
                                           Time latency = kPlanesLatency);
std::unique_ptr<Module> make_floor_module(const FloorEdgeOptions& options,
                                          Time latency = kFloorLatency);

// Of what the flow is of. An error where the posture is not known at both moments.
std::unique_ptr<Module> make_independent_motion_module(const IndependentMotionOptions& options,
                                                       Time latency = kMovingLatency);

}  // namespace kaz::vision
