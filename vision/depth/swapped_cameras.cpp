// Depth both ways round, in small pictures.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/swapped_cameras.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace kaz::vision {
namespace {

// Small: what was rectified for the other eye has its rows some pixels off, which block matching
// does not forgive.
constexpr int kWidth = 160;

Image shrunk(const Image& image, int width, int height) {
  const cv::Mat whole(image.height, image.width, CV_8UC3,
                      const_cast<std::uint8_t*>(image.rgb.data()));  // only read
  Image small{width, height,
              std::vector<std::uint8_t>(static_cast<std::size_t>(width * height) * 3)};
  cv::Mat target(height, width, CV_8UC3, small.rgb.data());
  cv::resize(whole, target, target.size(), 0, 0, cv::INTER_AREA);
  return small;
}

double known_share(const StereoImages& pair, const FrameInfo& info, const DepthOptions& options) {
  DepthFinder finder(options);
  DepthImage depth;
  if (!finder.find(pair, info, depth)) return 0;
  const auto known = std::count_if(depth.disparity_px.begin(), depth.disparity_px.end(),
                                   [](float d) { return d > 0; });
  return static_cast<double>(known) / static_cast<double>(depth.disparity_px.size());
}

bool whole(const Image& image, const CameraModel& camera) {
  return image.width == camera.width && image.height == camera.height && image.width >= kWidth &&
         image.height >= kWidth / 2 &&
         image.rgb.size() ==
             3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

}  // namespace

EyeOrder eye_order(const StereoImages& pair, const FrameInfo& info, const DepthOptions& options) {
  if (!whole(pair.left, info.camera) || !whole(pair.right, info.camera)) return EyeOrder::unclear;
  FrameInfo small = info;
  const double scale = static_cast<double>(kWidth) / info.camera.width;
  CameraModel& camera = small.camera;
  camera.width = kWidth;
  camera.height = static_cast<int>(info.camera.height * scale);
  if (camera.height < options.block_px) return EyeOrder::unclear;
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx *= scale;
  camera.cy *= scale;
  const Image left = shrunk(pair.left, camera.width, camera.height),
              right = shrunk(pair.right, camera.width, camera.height);
  // Patterns that repeat match by chance one period off, a tenth to a quarter of a chessboard's picture.
  // Swapped pictures, each rectified by the other eye's lens, have lost half of their depth: of OpenCV's
  // boards it is 1.8 to 5 times what they have as they are; where they are named rightly, 0.14 to 0.37 times.
  const double as_they_are = known_share({left, right}, small, options);
  const double exchanged = known_share({right, left}, small, options);
  constexpr double kMinShare = 0.1, kMinRatio = 1.5;
  if (exchanged > kMinShare && exchanged > kMinRatio * as_they_are) return EyeOrder::swapped;
  if (as_they_are > kMinShare && as_they_are > kMinRatio * exchanged) return EyeOrder::as_named;
  return EyeOrder::unclear;
}

void SwappedCameras::look(const StereoImages& pair, const FrameInfo& info) {
  if (looked_ >= kFirst && info.exposure < next_) return;
  next_ = info.exposure + kInterval;
  ++looked_;
  const EyeOrder order = eye_order(pair, info, options_);
  if (order == EyeOrder::as_named) ++as_named_;
  if (order == EyeOrder::swapped) ++swapped_;
}

bool SwappedCameras::found() const {
  constexpr int kEnough = 3;
  return swapped_ > 0 && swapped_ >= 2 * as_named_ &&
         (swapped_ >= kEnough || 2 * swapped_ >= looked_);
}

}  // namespace kaz::vision
