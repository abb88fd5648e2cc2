// The vision modules of Kaz, for a pipeline.
// SPDX-License-Identifier: Apache-2.0
//
// Names, results and needed modules:
// - color: BallObservation, the ball by its color in the left picture.
// - depth: DepthImage.
// - flow: FlowImage of the left picture since the previous frame. Its width is 0 if flow is unavailable.
// - planes: PlaneSegments. Needs depth.
// - floor: PlaneSegments with the edges of the floor refined on the left picture. Needs planes and depth.
// - moving: MovingRegions, independent motion. It has 0 cells across if the flow or its first picture is
//   unavailable. Needs flow and depth.
//
// The default latencies for lockstep come from measured runs.
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
// Gives no flow for the first frame, after a step back of the camera's clock, and if the previous frame is
// more than `longest` ago.
std::unique_ptr<Module> make_flow_module(const FlowOptions& options, Time latency = kFlowLatency,
                                         Time longest = std::chrono::milliseconds(200));
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options,
                                           Time latency = kPlanesLatency);
std::unique_ptr<Module> make_floor_module(const FloorEdgeOptions& options,
                                          Time latency = kFloorLatency);

// Gives an error if the posture at either exposure is unknown.
std::unique_ptr<Module> make_independent_motion_module(const IndependentMotionOptions& options,
                                                       Time latency = kMovingLatency);

}  // namespace kaz::vision
