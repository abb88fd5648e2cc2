// Creates the vision modules of Kaz for a pipeline.
// SPDX-License-Identifier: Apache-2.0
//
// Name, result and needed modules of each module:
// - color: BallObservation, the ball that is detected by its color in the left picture.
// - depth: DepthImage.
// - flow: FlowImage, the optical flow from the previous left picture to the present one. The width of the
//   flow image is 0 if flow is unavailable.
// - planes: PlaneSegments. Needs depth.
// - floor: PlaneSegments in which the edges of the floor are refined with the left picture. Needs the
//   modules `planes` and `depth`.
// - moving: MovingRegions, the independently moving objects. `cells_across` is 0 if the flow or the earlier
//   picture is unavailable. Needs the modules `flow` and `depth`.
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
// The flow image is empty for the first frame and after the camera's clock stepped back. The flow image is
// also empty if the previous frame was exposed more than `longest` before the present frame.
std::unique_ptr<Module> make_flow_module(const FlowOptions& options, Time latency = kFlowLatency,
                                         Time longest = std::chrono::milliseconds(200));
std::unique_ptr<Module> make_planes_module(const PlaneOptions& options,
                                           Time latency = kPlanesLatency);
std::unique_ptr<Module> make_floor_module(const FloorEdgeOptions& options,
                                          Time latency = kFloorLatency);

// The module returns an error if the posture at either exposure is unknown.
std::unique_ptr<Module> make_independent_motion_module(const IndependentMotionOptions& options,
                                                       Time latency = kMovingLatency);

}  // namespace kaz::vision
