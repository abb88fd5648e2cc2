// docs/reference/camera-stream.md states the sizes, offsets and constants of shared/base/camera_stream.hpp.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "host/camera/camera_stream.h"
#include "shared/base/camera_stream.hpp"

namespace kaz::host {
namespace {

std::string page() {
  std::ostringstream text;
  text << std::ifstream("docs/reference/camera-stream.md").rdbuf();
  return text.str();
}

std::string row(std::size_t offset, const std::string& type, const std::string& name) {
  return "| " + std::to_string(offset) + " | " + type + " | `" + name + "` |";
}

TEST(CameraStreamPage, ListsEachFieldAtItsOffset) {
  const std::string text = page();
  ASSERT_FALSE(text.empty()) << "the tests run in the root of the tree";
  using Header = CameraStreamHeader;
  using Pair = CameraStreamPair;
  const std::string rows[] = {row(offsetof(Header, magic), "char[4]", "magic"),
                              row(offsetof(Header, version), "u32", "version"),
                              row(offsetof(Header, width), "u32", "width"),
                              row(offsetof(Header, height), "u32", "height"),
                              row(offsetof(Header, fx), "f64", "fx"),
                              row(offsetof(Header, fy), "f64", "fy"),
                              row(offsetof(Header, cx), "f64", "cx"),
                              row(offsetof(Header, cy), "f64", "cy"),
                              row(offsetof(Header, baseline_m), "f64", "baseline_m"),
                              row(offsetof(Header, latency_ns), "s64", "latency_ns"),
                              row(offsetof(Pair, magic), "char[4]", "magic"),
                              row(offsetof(Pair, reserved), "u32", "reserved"),
                              row(offsetof(Pair, sequence), "u64", "sequence"),
                              row(offsetof(Pair, exposure_ns), "s64", "exposure_ns")};
  for (const std::string& expected : rows)
    EXPECT_NE(text.find(expected), std::string::npos) << expected;
}

TEST(CameraStreamPage, StatesSizesAndConstants) {
  const std::string text = page();
  const std::string pair = std::to_string(sizeof(CameraStreamPair));
  const std::string side = std::to_string(kCameraStreamMaxSide);
  const std::string seconds = std::to_string(kMaxCameraLatency / std::chrono::seconds(1));
  ASSERT_EQ(camera_picture_bytes(320, 240), 3u * 320 * 240);
  ASSERT_EQ(kMaxCameraAhead, kMaxCameraLatency) << "the page states one number for both";
  for (const std::string& expected :
       {"header of a camera stream has " + std::to_string(sizeof(CameraStreamHeader)) + " bytes",
        pair + " + 2 × 3 × width × height bytes",
        "| " + pair + " | u8[3 × width × height] | left |",
        "| " + pair + " + 3 × width × height | u8[3 × width × height] | right |",
        "| `magic` | `" + std::string(kCameraStreamMagic, 4) + "` |",
        "| `magic` | `" + std::string(kCameraPairMagic, 4) + "`:",
        "| `version` | " + std::to_string(kCameraStreamVersion) + ";", "px, 1 to " + side,
        "ns, 0 to " + seconds + " s"})
    EXPECT_NE(text.find(expected), std::string::npos) << expected;
}

}  // namespace
}  // namespace kaz::host
