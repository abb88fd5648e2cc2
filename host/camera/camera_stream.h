// Parses and validates a published camera's messages: stream header and pair header.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "shared/base/camera_stream.hpp"
#include "vision/image/frame.h"

namespace kaz::host {

struct CameraStream {
  vision::CameraModel model;
  Time latency{};  // time from the middle of the exposure to the delivery of the pair
};

// kMaxCameraLatency is the maximum latency. kMaxCameraAhead is the maximum time by which an exposure may be
// later than the reader's clock. Writer and reader of a stream use CLOCK_MONOTONIC of the same machine.
inline constexpr Time kMaxCameraLatency = std::chrono::seconds(10);
inline constexpr Time kMaxCameraAhead = std::chrono::seconds(10);

// Fails (environment) if `header` is not the header of a camera stream, has an unsupported version, or
// declares an invalid camera. A camera is invalid if its size, intrinsics, baseline or latency is out of
// range. Messages contain `path`.
Result<CameraStream> parse(const CameraStreamHeader& header, const std::string& path);
// Fails (environment) if `pair` is not the header of a stereo pair. Also fails if the time of the exposure is
// negative, or later than `now` + kMaxCameraAhead.
Result<vision::FrameInfo> parse(const CameraStreamPair& pair, const CameraStream& stream, Time now,
                                const std::string& path);

}  // namespace kaz::host
