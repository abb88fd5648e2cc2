// What two pictures must have in common for flow between them.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow_pair.h"

#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

namespace kaz::vision {
namespace {

constexpr int kLargest_px = 8192;

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Result<void> check_picture(const char* name, const ImageView& picture, const CameraModel& camera) {
  const int width = picture.width, height = picture.height;
  const std::string what = std::string("flow: the ") + name + " picture ";
  const std::string size = size_text(width, height);
  if (width <= 0 || height <= 0 || picture.bytes.empty())
    return fail(Fault::usage, what + "is empty: check that the camera is running");
  if (width > kLargest_px || height > kLargest_px)
    return fail(Fault::usage,
                what + "has " + size + " pixels, more than 8192 per side: scale the picture down");
  if (width < kSmallestFlow_px || height < kSmallestFlow_px)
    return fail(Fault::usage,
                what + "has " + size + " pixels, fewer than 64 per side: use larger pictures");
  const std::size_t needed = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                             static_cast<std::size_t>(picture.channels);
  if (picture.bytes.size() != needed)
    return fail(Fault::usage, what + "has " + std::to_string(picture.bytes.size()) +
                                  " bytes, but " + size + " pixels need " + std::to_string(needed) +
                                  ": the picture is truncated or padded");
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(camera.fx) || !positive(camera.fy) || !std::isfinite(camera.cx) ||
      !std::isfinite(camera.cy))
    return fail(Fault::usage, std::string("flow: the camera model of the ") + name +
                                  " picture has no focal length: calibrate the eyes");
  if (camera.width != width || camera.height != height)
    return fail(Fault::usage, what + "has " + size + " pixels, but its camera model has " +
                                  size_text(camera.width, camera.height) +
                                  ": use a calibration for the size of the picture");
  return {};
}

}  // namespace

Result<void> check_flow_pair(const ImageView& before, const FrameInfo& info_before,
                             const ImageView& after, const FrameInfo& info_after) {
  if (auto ok = check_picture("earlier", before, info_before.camera); !ok) return ok;
  if (auto ok = check_picture("later", after, info_after.camera); !ok) return ok;
  if (before.width != after.width || before.height != after.height)
    return fail(Fault::usage, "flow: the earlier picture has " +
                                  size_text(before.width, before.height) +
                                  " pixels, the later one " + size_text(after.width, after.height) +
                                  ": both must come from one eye");
  const CameraModel &a = info_before.camera, &b = info_after.camera;
  if (a.fx != b.fx || a.fy != b.fy || a.cx != b.cx || a.cy != b.cy)
    return fail(Fault::usage,
                "flow: the camera models of the two pictures differ: both must come from one eye");
  if (info_after.exposure <= info_before.exposure)
    return fail(
        Fault::failed,
        "flow: the second picture must be exposed after the first picture, but the first picture "
        "was exposed " +
            std::to_string(seconds(between(info_before.exposure, info_after.exposure))) +
            " s after the second picture: the clock jumped back, so start again with the "
            "second picture");
  return {};
}

cv::Mat flow_grey(const ImageView& image, cv::Mat& memory) {
  // The pixels are only read.
  const cv::Mat given(image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1,
                      const_cast<std::uint8_t*>(image.bytes.data()));
  if (image.channels == 1) return given;
  cv::cvtColor(given, memory, cv::COLOR_RGB2GRAY);
  return memory;
}

}  // namespace kaz::vision
