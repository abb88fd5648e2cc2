// Wire format of stereo pairs published by one process (`kaz sim --cameras PATH`) to others.
// SPDX-License-Identifier: Apache-2.0
//
// PATH is a Unix stream socket on which the publisher listens. To each reader that connects it
// sends
//   CameraStreamHeader, then for each pair: CameraStreamPair, left picture, right picture
// with a picture being width * height * 3 bytes, RGB, rows from top to bottom, no padding. Readers
// send nothing. Numbers are little-endian at the offsets below. The end of the stream is a closed
// socket, also within a pair. Who writes a reader: docs/reference/camera-stream.md.
//
// The publisher sends a pair as soon as it is drawn and never waits for a slow reader: it leaves
// out whole pairs for that reader (`sequence` shows the gap). A reader gives a pair to its user no
// sooner than `exposure_ns + latency_ns`, so that the time the drawing took does not show (design,
// section 3).
#ifndef KAZ_SHARED_BASE_CAMERA_STREAM_HPP
#define KAZ_SHARED_BASE_CAMERA_STREAM_HPP

#include <bit>
#include <cstddef>
#include <cstdint>

namespace kaz {

inline constexpr char kCameraStreamMagic[4] = {'K', 'A', 'Z', 'C'};
inline constexpr char kCameraPairMagic[4] = {'P', 'A', 'I', 'R'};
inline constexpr std::uint32_t kCameraStreamVersion = 1;
inline constexpr std::uint32_t kCameraStreamMaxSide = 4096;  // pixels; a reader refuses more

struct CameraStreamHeader {
  char magic[4];            // kCameraStreamMagic
  std::uint32_t version;    // kCameraStreamVersion
  std::uint32_t width;      // pixels, 1..kCameraStreamMaxSide
  std::uint32_t height;     // pixels
  double fx, fy, cx, cy;    // pixels; pixel centres at integer coordinates (vision/image/frame.h)
  double baseline_m;        // right lens along +x of the left optical frame
  std::int64_t latency_ns;  // from the middle of the exposure to when the pair reaches vision, >= 0
};

struct CameraStreamPair {
  char magic[4];             // kCameraPairMagic: a reader that lost its place notices
  std::uint32_t reserved;    // 0
  std::uint64_t sequence;    // of the exposure, counted from 0 since the publisher started
  std::int64_t exposure_ns;  // middle of the exposure on CLOCK_MONOTONIC
};

constexpr std::size_t camera_picture_bytes(std::uint32_t width, std::uint32_t height) {
  return std::size_t{width} * height * 3;
}

static_assert(std::endian::native == std::endian::little, "the stream is little-endian");
static_assert(sizeof(CameraStreamHeader) == 64 && offsetof(CameraStreamHeader, fx) == 16 &&
              offsetof(CameraStreamHeader, latency_ns) == 56);
static_assert(sizeof(CameraStreamPair) == 24 && offsetof(CameraStreamPair, exposure_ns) == 16);

}  // namespace kaz

#endif
