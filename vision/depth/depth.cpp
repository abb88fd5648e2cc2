// Depth from a rectified stereo pair: validation of the input, block matching, point clouds.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth/depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/depth/depth_match.h"

namespace kaz::vision {
namespace {

constexpr int kLargest_px = 8192;

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

// The caller's picture: `channels` x 8 bits a pixel (1: grey, 3: RGB), rows from the top, no padding.
struct GreySource {
  int width, height, channels;
  std::span<const std::uint8_t> bytes;
};

Result<void> check_picture(const char* name, const GreySource& picture, int block) {
  const int width = picture.width, height = picture.height;
  const std::size_t size = picture.bytes.size();
  const std::string what = std::string("depth: the ") + name + " picture ";
  if (width <= 0 || height <= 0 || size == 0)
    return fail(Fault::usage, what + "is empty: check that the camera is running");
  if (width > kLargest_px || height > kLargest_px)
    return fail(Fault::usage, what + "has " + size_text(width, height) +
                                  " pixels, more than 8192 per side: scale the picture down");
  if (width <= 2 * block || height <= 2 * block)
    return fail(Fault::usage, what + "has " + size_text(width, height) +
                                  " pixels, too few for blocks of " + std::to_string(block) +
                                  ": use smaller blocks or larger pictures");
  const std::size_t needed = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                             static_cast<std::size_t>(picture.channels);
  if (size != needed)
    return fail(Fault::usage, what + "has " + std::to_string(size) + " bytes, but " +
                                  size_text(width, height) + " pixels need " +
                                  std::to_string(needed) + ": the picture is truncated or padded");
  return {};
}

Result<void> check_camera(const CameraModel& camera, int width, int height) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(camera.fx) || !positive(camera.fy) || !std::isfinite(camera.cx) ||
      !std::isfinite(camera.cy))
    return fail(Fault::usage, "depth: the camera model has no focal length: calibrate the eyes");
  if (!positive(camera.baseline_m))
    return fail(Fault::usage,
                "depth: the camera model has no baseline: calibrate the eyes as a pair");
  if (camera.width != width || camera.height != height)
    return fail(Fault::usage, "depth: the pictures have " + size_text(width, height) +
                                  " pixels, but the camera model has " +
                                  size_text(camera.width, camera.height) +
                                  ": use a calibration for the size of the pictures");
  return {};
}

Result<void> check_options(const DepthOptions& o) {
  if (o.block_px < 5 || o.block_px > kLargestBlock || o.block_px % 2 == 0)
    return fail(Fault::usage, "depth: block_px must be odd and 5 to 21");
  if (!(o.nearest_m > 0)) return fail(Fault::usage, "depth: nearest_m must be above 0");
  if (o.min_texture < 0 || o.uniqueness_percent < 0 || o.uniqueness_percent > 100)
    return fail(Fault::usage,
                "depth: min_texture must be at least 0, and uniqueness_percent must be 0 to 100");
  return {};
}

// The picture's own bytes if it is grey, else their luma (OpenCV's RGB2GRAY) in `grey`.
const std::uint8_t* grey_of(const GreySource& picture, std::vector<std::uint8_t>& grey) {
  if (picture.channels == 1) return picture.bytes.data();
  grey.resize(picture.bytes.size() / 3);
  const cv::Mat from(picture.height, picture.width, CV_8UC3,
                     const_cast<std::uint8_t*>(picture.bytes.data()));  // only read from
  cv::Mat to(picture.height, picture.width, CV_8UC1, grey.data());
  cv::cvtColor(from, to, cv::COLOR_RGB2GRAY);
  return grey.data();
}

}  // namespace

struct DepthFinder::State {
  DepthOptions options;
  StereoMatcher matcher;
  std::vector<std::uint8_t> left, right;  // grey

  // Number of disparities: d_max = fx baseline / z_min, rounded up to a multiple of 16, the SIMD width.
  Result<int> disparities(int width, const CameraModel& camera) const {
    const double max_disparity = std::ceil(camera.fx * camera.baseline_m / options.nearest_m);
    if (!(max_disparity < width))
      return fail(
          Fault::usage,
          "depth: the pictures of the eyes do not overlap at nearest_m: increase nearest_m");
    return std::max(16, (static_cast<int>(max_disparity) + 15) / 16 * 16);
  }

  Result<void> find(const GreySource& l, const GreySource& r, const FrameInfo& info,
                    DepthImage& depth) {
    depth.info = info;
    if (auto ok = check_options(options); !ok) return ok;
    for (const auto& [name, side] : {std::pair{"left", &l}, {"right", &r}}) {
      if (auto ok = check_picture(name, *side, options.block_px); !ok) return ok;
    }
    if (l.width != r.width || l.height != r.height)
      return fail(Fault::usage, "depth: the left picture has " + size_text(l.width, l.height) +
                                    " pixels, the right one " + size_text(r.width, r.height) +
                                    ": both must be rectified to one size");
    if (auto ok = check_camera(info.camera, l.width, l.height); !ok) return ok;
    const auto count = KAZ_TRY(disparities(l.width, info.camera));
    const std::uint8_t *left_grey = grey_of(l, left), *right_grey = grey_of(r, right);
    const std::size_t pixels =
        static_cast<std::size_t>(l.width) * static_cast<std::size_t>(l.height);
    for (const auto& [name, grey] : {std::pair{"left", left_grey}, {"right", right_grey}}) {
      if (std::all_of(grey, grey + pixels, [first = *grey](std::uint8_t x) { return x == first; }))
        return fail(Fault::failed,
                    std::string("depth: the ") + name +
                        " picture has a single color: check the lens cover and the light");
    }
    depth.width = l.width;
    depth.height = l.height;
    matcher.match(
        {left_grey, right_grey, l.width, l.height}, count,
        {{options.block_px, options.uniqueness_percent, options.left_right_px, options.vectors},
         options.min_texture,
         options.slants},
        depth.disparity_px);
    return {};
  }
};

DepthFinder::DepthFinder(const DepthOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
}
DepthFinder::~DepthFinder() = default;
DepthFinder::DepthFinder(DepthFinder&&) noexcept = default;
DepthFinder& DepthFinder::operator=(DepthFinder&&) noexcept = default;

Result<void> DepthFinder::find(const StereoImages& pair, const FrameInfo& info, DepthImage& depth) {
  const auto source_of = [](const Image& image) {
    return GreySource{image.width, image.height, 3, image.rgb};
  };
  return state_->find(source_of(pair.left), source_of(pair.right), info, depth);
}

Result<void> DepthFinder::find(const GreyPicture& l, const GreyPicture& r, const FrameInfo& info,
                               DepthImage& depth) {
  const auto source_of = [](const GreyPicture& picture) {
    return GreySource{picture.width, picture.height, 1, picture.pixels};
  };
  return state_->find(source_of(l), source_of(r), info, depth);
}

// Pinhole back-projection, optical frame, m: z = fx b / d, x = (u - cx) z / fx, y = (v - cy) z / fy.
void point_cloud(const DepthImage& depth, PointCloud& cloud) {
  const CameraModel& c = depth.info.camera;
  const auto f = static_cast<float>(c.fx * c.baseline_m);
  const auto per_x = static_cast<float>(1 / c.fx), per_y = static_cast<float>(1 / c.fy);
  cloud.width = depth.width;
  cloud.height = depth.height;
  cloud.points.resize(depth.disparity_px.size());
  std::size_t i = 0;
  for (int v = 0; v < depth.height; ++v) {
    const float y = (static_cast<float>(v) - static_cast<float>(c.cy)) * per_y;
    for (int u = 0; u < depth.width; ++u, ++i) {
      const float d = depth.disparity_px[i];
      const float z = d > 0 ? f / d : std::numeric_limits<float>::quiet_NaN();
      const float x = (static_cast<float>(u) - static_cast<float>(c.cx)) * per_x;
      cloud.points[i] = {x * z, y * z, z};
    }
  }
}

Result<void> point_cloud_before_foot(const DepthImage& depth, PointCloud& cloud) {
  if (!depth.info.posture_known)
    return fail(
        Fault::failed,
        "depth: the robot's posture at the exposure of the picture is not known, so the points "
        "cannot be given relative to the foot: wait until the board has sent its state");
  point_cloud(depth, cloud);
  const Eigen::Isometry3f foot_from_eye = depth.info.foot_from_eye.cast<float>();
  for (Eigen::Vector3f& p : cloud.points) p = foot_from_eye * p;
  return {};
}

}  // namespace kaz::vision
