// What a published camera sends, checked: header of the stream, head of a pair.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/camera_stream.hpp"
#include "vision/image/frame.h"

namespace kaz::host {

struct CameraStream {
  vision::CameraModel model;
  Time latency{};  // from the middle of the exposure to the delivery of the pair
};

// The longest latency, and the furthest that an exposure may lie ahead of the reader's clock, which is
// the publisher's: CLOCK_MONOTONIC of one machine.
inline constexpr Time kMaxCameraLatency = std::chrono::seconds(10);
inline constexpr Time kMaxCameraAhead = std::chrono::seconds(10);

// Errors (environment), each one sentence with `path`: no camera stream, another version, invalid camera
// parameters (sizes, intrinsics or baseline not finite or out of range).
Result<CameraStream> parse(const CameraStreamHeader& header, const std::string& path);
// Errors (environment): no pair, an exposure before the clock's start or far after `now`.
Result<vision::FrameInfo> parse(const CameraStreamPair& pair, const CameraStream& stream, Time now,
                                const std::string& path);

}  // namespace kaz::host
