// Wire format of stereo pairs that one process publishes to others, for example `kaz sim --cameras PATH`.
// SPDX-License-Identifier: Apache-2.0
//
// PATH is a Unix stream socket on which the publisher listens. The publisher sends the following data to each
// connected reader:
//   CameraStreamHeader, then for each pair: CameraStreamPair, left picture, right picture
//
// A picture is width * height * 3 bytes of RGB, rows from top to bottom, without padding. Numbers are
// little-endian, at the offsets of the structs below. Readers send nothing. The stream ends when the
// publisher closes the socket, possibly within a pair. To write a program that reads the stream, see the page
// docs/reference/camera-stream.md.
//
// The publisher sends a pair as soon as the pair is drawn and never waits for a slow reader. The publisher
// skips whole pairs for a slow reader; gaps in `sequence` show the skipped pairs. A reader should not use a
// pair before the time `exposure_ns + latency_ns`. With this rule, all pairs have the same delay, even if the
// publisher draws some pairs more slowly than others.
#ifndef KAZ_SHARED_BASE_CAMERA_STREAM_HPP
#define KAZ_SHARED_BASE_CAMERA_STREAM_HPP

#include <bit>
#include <cstddef>
#include <cstdint>

namespace kaz {

inline constexpr char kCameraStreamMagic[4] = {'K', 'A', 'Z', 'C'};
inline constexpr char kCameraPairMagic[4] = {'P', 'A', 'I', 'R'};
inline constexpr std::uint32_t kCameraStreamVersion = 1;
// Maximum width and maximum height of a picture in pixels. Readers reject larger pictures.
inline constexpr std::uint32_t kCameraStreamMaxSide = 4096;

struct CameraStreamHeader {
  char magic[4];            // kCameraStreamMagic
  std::uint32_t version;    // kCameraStreamVersion
  std::uint32_t width;      // pixels, 1..kCameraStreamMaxSide
  std::uint32_t height;     // pixels
  double fx, fy, cx, cy;    // pixels; pixel centers have integer coordinates (vision/image/frame.h)
  double baseline_m;        // offset of the right lens along +x of the left optical frame, m
  std::int64_t latency_ns;  // time from the middle of the exposure to delivery, >= 0
};

struct CameraStreamPair {
  // kCameraPairMagic. If a reader finds a different value here, the reader has lost synchronization.
  char magic[4];
  std::uint32_t reserved;    // 0
  std::uint64_t sequence;    // number of the exposure, from 0 at the publisher's start
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
