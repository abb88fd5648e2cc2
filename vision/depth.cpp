// Depth from a rectified stereo pair: checks around OpenCV's block matching.
// SPDX-License-Identifier: Apache-2.0
#include "vision/depth.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kaz::vision {
namespace {

constexpr int kLargest_px = 8192;

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

// A picture as it was given: so many channels of 8 bits, rows from the top.
struct Sight {
  int width, height, channels;
  std::span<const std::uint8_t> bytes;
};

Result<void> check_picture(const char* name, const Sight& picture, int block) {
  const int width = picture.width, height = picture.height;
  const std::size_t size = picture.bytes.size();
  const std::string what = std::string("depth: the ") + name + " picture ";
  if (width <= 0 || height <= 0 || size == 0)
    return fail(Fault::usage, what + "is empty: is the camera running?");
  if (width > kLargest_px || height > kLargest_px)
    return fail(Fault::usage, what + "has " + size_text(width, height) +
                                  " pixels, more than 8192 a side: scale it down");
  if (width <= 2 * block || height <= 2 * block)
    return fail(Fault::usage, what + "has " + size_text(width, height) +
                                  " pixels, too few for blocks of " + std::to_string(block) +
                                  ": take smaller blocks or larger pictures");
  const std::size_t needed = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                             static_cast<std::size_t>(picture.channels);
  if (size != needed)
    return fail(Fault::usage, what + "has " + std::to_string(size) + " bytes where " +
                                  size_text(width, height) + " pixels need " +
                                  std::to_string(needed) + ": it was cut short or is padded");
  return {};
}

Result<void> check_camera(const CameraModel& camera, int width, int height) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(camera.fx) || !positive(camera.fy) || !std::isfinite(camera.cx) ||
      !std::isfinite(camera.cy))
    return fail(Fault::usage, "depth: the camera model has no focal length: calibrate the eyes");
  if (!positive(camera.baseline_m))
    return fail(
        Fault::usage,
        "depth: the camera model has no distance between the eyes: calibrate them as a pair");
  if (camera.width != width || camera.height != height)
    return fail(Fault::usage, "depth: the pictures have " + size_text(width, height) +
                                  " pixels, the camera model " +
                                  size_text(camera.width, camera.height) +
                                  ": take the calibration of this size");
  return {};
}

Result<void> check_options(const DepthOptions& o) {
  if (o.block_px < 5 || o.block_px > 51 || o.block_px % 2 == 0)
    return fail(Fault::usage, "depth: block_px must be odd and 5 to 51");
  if (!(o.nearest_m > 0)) return fail(Fault::usage, "depth: nearest_m must be above 0");
  if (o.least_texture < 0 || o.uniqueness_percent < 0 || o.uniqueness_percent > 100)
    return fail(Fault::usage,
                "depth: least_texture must be 0 or more and uniqueness_percent 0 to 100");
  return {};
}

cv::Mat as_mat(const std::uint8_t* data, int width, int height, int type) {
  return {height, width, type, const_cast<std::uint8_t*>(data)};  // only read from
}

}  // namespace

struct DepthFinder::State {
  DepthOptions options;
  cv::Ptr<cv::StereoBM> matcher;
  // With columns to the left of the picture, so that matching does not begin as many columns from
  // its edge as there are disparities: far things are seen there by both eyes.
  cv::Mat left, right;
  cv::Mat sixteenths;

  Result<int> prepare(int width, int height, const CameraModel& camera) {
    const double most = std::ceil(camera.fx * camera.baseline_m / options.nearest_m);
    if (!(most < width))
      return fail(Fault::usage,
                  "depth: at nearest_m the eyes' pictures have nothing in common: raise it");
    const int disparities = std::max(16, (static_cast<int>(most) + 15) / 16 * 16);
    if (!matcher) {
      matcher = cv::StereoBM::create(disparities, options.block_px);
      matcher->setPreFilterType(cv::StereoBM::PREFILTER_XSOBEL);
      matcher->setPreFilterCap(31);
      matcher->setTextureThreshold(options.least_texture * options.block_px * options.block_px /
                                   225);
      matcher->setUniquenessRatio(options.uniqueness_percent);
      matcher->setDisp12MaxDiff(options.left_right_px);
    }
    matcher->setNumDisparities(disparities);
    left.create(height, width + disparities, CV_8UC1);
    right.create(height, width + disparities, CV_8UC1);
    return disparities;
  }

  // Of one size, grey, beside the columns that matching needs.
  Result<void> find(const Sight& l, const Sight& r, const FrameInfo& info, DepthImage& depth) {
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
    const auto disparities = prepare(l.width, l.height, info.camera);
    if (!disparities) return tl::unexpected(disparities.error());
    for (const auto& [side, grey] : {std::pair{&l, &left}, {&r, &right}}) {
      const cv::Mat pixels = as_mat(side->bytes.data(), side->width, side->height,
                                    side->channels == 3 ? CV_8UC3 : CV_8UC1);
      cv::Mat to = grey->colRange(*disparities, *disparities + side->width);
      if (side->channels == 3) {
        cv::cvtColor(pixels, to, cv::COLOR_RGB2GRAY);
      } else {
        pixels.copyTo(to);
      }
    }
    return match(l.width, l.height, *disparities, depth);
  }

  Result<void> match(int width, int height, int disparities, DepthImage& depth) {
    for (cv::Mat* side : {&left, &right}) {
      double least = 0, most = 0;
      cv::minMaxLoc(side->colRange(disparities, disparities + width), &least, &most);
      if (least == most)
        return fail(Fault::failed, std::string("depth: the ") + (side == &left ? "left" : "right") +
                                       " picture has one colour from edge to edge: is the lens "
                                       "covered, is there light?");
      for (int v = 0; v < height; ++v) {
        std::uint8_t* row = side->ptr(v);
        std::fill(row, row + disparities, row[disparities]);
      }
    }
    matcher->compute(left, right, sixteenths);
    depth.width = width;
    depth.height = height;
    depth.disparity_px.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int half = options.block_px / 2;
    for (int v = 0; v < height; ++v) {
      const std::int16_t* from = sixteenths.ptr<std::int16_t>(v) + disparities;
      float* to =
          &depth.disparity_px[static_cast<std::size_t>(v) * static_cast<std::size_t>(width)];
      for (int u = 0; u < width; ++u) {
        // A block that would reach into the columns before the right picture has matched nothing.
        const int room = 16 * (u - half);
        to[u] = from[u] > 0 && from[u] <= room ? static_cast<float>(from[u]) / 16 : 0.0F;
      }
    }
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
  const auto sight = [](const Image& image) {
    return Sight{image.width, image.height, 3, image.rgb};
  };
  return state_->find(sight(pair.left), sight(pair.right), info, depth);
}

Result<void> DepthFinder::find(const GreyPicture& l, const GreyPicture& r, const FrameInfo& info,
                               DepthImage& depth) {
  const auto sight = [](const GreyPicture& picture) {
    return Sight{picture.width, picture.height, 1, picture.pixels};
  };
  return state_->find(sight(l), sight(r), info, depth);
}

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
    return fail(Fault::failed,
                "depth: the posture at the moment of the picture is not known, so nothing can be "
                "placed before the foot: wait for the board's state");
  point_cloud(depth, cloud);
  const Eigen::Isometry3f foot_from_eye = depth.info.foot_from_eye.cast<float>();
  for (Eigen::Vector3f& p : cloud.points) p = foot_from_eye * p;
  return {};
}

}  // namespace kaz::vision
