// Camera model: tolerances of the series, remap table of the lens, noise row by row.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/sensor/sensor.h"

#include <algorithm>
#include <cmath>

#include "shared/base/random.hpp"
#include "sim/render/camera.h"

namespace kaz::sim {
namespace {

using vision::Lens;

constexpr double kDensity = 0.92;

double deviation(std::uint64_t unit, std::uint64_t eye, std::uint64_t what) {
  return std::clamp(keyed_normal(unit, eye, what), -2.5, 2.5);
}

vision::StereoCalibration::Eye copy_of(const EyeModel& model, std::uint64_t unit,
                                       std::uint64_t eye) {
  const auto off = [&](std::uint64_t what) { return deviation(unit, eye, what); };
  vision::StereoCalibration::Eye copy;
  Lens& lens = copy.lens;
  // Focal length such that the distorted ray at half the view angle ends at half the width:
  // f = width / 2 / x_d(tan(view / 2)), px.
  lens.distortion = model.distortion;
  const double edge = lens.distort({std::tan(0.5 * model.lens_view_rad), 0}).x();
  const double focal = 0.5 * model.width / edge;
  lens.distortion[0] *= 1 + model.distortion_spread * off(0);
  lens.distortion[1] *= 1 + model.distortion_spread * off(1);
  lens.distortion[2] += model.tangential_spread * off(2);
  lens.distortion[3] += model.tangential_spread * off(3);
  lens.fx = lens.fy = focal * (1 + model.focal_spread * off(4));
  lens.cx = 0.5 * (model.width - 1) + model.centre_spread * model.width * off(5);
  lens.cy = 0.5 * (model.height - 1) + model.centre_spread * model.width * off(6);
  const double s = model.direction_spread_rad;
  copy.rectified_from_camera = (Eigen::AngleAxisd(s * off(7), Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(s * off(8), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(s * off(9), Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  return copy;
}

const vision::StereoCalibration::Eye& eye_of(const vision::StereoCalibration& calibration,
                                             Sensor::Eye eye) {
  return eye == Sensor::Eye::left ? calibration.left : calibration.right;
}

// Pinhole that contains all rays of the lens: bounds of the undistorted directions x/z, y/z along the
// picture's border, where they are extreme.
vision::CameraModel pinhole_around(const Lens& lens, int width, int height, double focal) {
  Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
  const auto reach = [&](double u, double v) {
    const Eigen::Array2d d = lens.direction({u, v}).array();
    low = low.min(d);
    high = high.max(d);
  };
  for (int u = 0; u < width; ++u) {
    reach(u, 0);
    reach(u, height - 1);
  }
  for (int v = 0; v < height; ++v) {
    reach(0, v);
    reach(width - 1, v);
  }
  // One pixel of margin on each side, rounded up to blocks of four (llvmpipe).
  const auto side = [&](double from, double to) {
    return (static_cast<int>(std::ceil(focal * (to - from))) + 3 + 3) / 4 * 4;
  };
  vision::CameraModel p;
  p.fx = p.fy = focal;
  p.width = side(low.x(), high.x());
  p.height = side(low.y(), high.y());
  p.cx = 1 - low.x() * focal;
  p.cy = 1 - low.y() * focal;
  return p;
}

// Remap table of the lens: pixel (u, v) samples the pinhole picture at its undistorted direction d, with the
// gain sqrt(1 - vignetting r^2 / r_corner^2).
vision::Remap table_of(const EyeModel& model, const Lens& lens, const vision::CameraModel& ideal) {
  const double corner =
      0.25 * (model.width * model.width + model.height * model.height);  // px, squared
  return {{model.width, model.height},
          {ideal.width, ideal.height},
          [&](int u, int v) -> vision::Remap::Place {
            const Eigen::Vector2d d = lens.direction({u, v});
            const double x = u - lens.cx, y = v - lens.cy;
            const double light = 1 - model.vignetting * std::min(1.0, (x * x + y * y) / corner);
            // A code is the square root of its light.
            return {ideal.fx * d.x() + ideal.cx, ideal.fy * d.y() + ideal.cy, std::sqrt(light)};
          }};
}

}  // namespace

vision::StereoCalibration make_calibration(const EyeModel& model, std::uint64_t unit,
                                           double baseline_m) {
  vision::StereoCalibration calibration;
  calibration.width = model.width;
  calibration.height = model.height;
  calibration.left = copy_of(model, unit, 0);
  calibration.right = copy_of(model, unit, 1);
  calibration.rectified = camera_of_view(model.width, model.height, model.rectified_view_rad);
  calibration.rectified.baseline_m = baseline_m;
  return calibration;
}

Sensor::Sensor(const EyeModel& model, const vision::StereoCalibration& calibration, Eye eye,
               std::uint64_t noise_seed)
    : ideal_(pinhole_around(eye_of(calibration, eye).lens, model.width, model.height,
                            kDensity * calibration.rectified.fx)),
      rotation_(eye_of(calibration, eye).rectified_from_camera),
      lens_(table_of(model, eye_of(calibration, eye).lens, ideal_)),
      noise_(model.noise),
      eye_(eye) {
  set_noise_seed(noise_seed);
  limit(lens_.all_rows());
}

void Sensor::set_noise_seed(std::uint64_t seed) {
  key_ = mix64(mix64(seed) ^ static_cast<std::uint64_t>(eye_));
}

void Sensor::limit(std::span<const vision::Remap::Columns> rows) {
  rows_.assign(rows.begin(), rows.end());
  const auto sources = lens_.sources(rows);
  ideal_part_ = {ideal_.width, ideal_.height, 0, 0};
  for (int v = 0; v < ideal_.height; ++v) {
    const auto [first, end] = sources[static_cast<std::size_t>(v)];
    if (end <= first) continue;
    ideal_part_ = {std::min(ideal_part_.left, first), std::min(ideal_part_.top, v),
                   std::max(ideal_part_.right, end), v + 1};
  }
}

Eigen::Isometry3d Sensor::mounting_from_optical() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_;
  return pose;
}

void Sensor::expose(const vision::Image& ideal, std::uint64_t exposure,
                    vision::Image& picture) const {
  picture.width = lens_.size().width;
  picture.height = lens_.size().height;
  const std::size_t row = 3 * static_cast<std::size_t>(picture.width);
  picture.rgb.resize(row * static_cast<std::size_t>(picture.height));
  std::vector<std::uint16_t> codes(row + 8);
  const std::uint64_t key = mix64(key_ ^ exposure);
  for (int v = 0; v < picture.height; ++v) {
    const vision::Remap::Columns columns = rows_[static_cast<std::size_t>(v)];
    if (columns.end <= columns.first) continue;
    lens_.row(ideal.rgb, v, columns, codes.data());
    const auto number = static_cast<std::uint64_t>(v);
    noise_.expose(
        codes.data(), picture.rgb.data() + number * row,
        {3 * static_cast<std::size_t>(columns.first), 3 * static_cast<std::size_t>(columns.end)},
        mix64(key ^ number));
  }
}

void Sensor::bend(const vision::Image& ideal, vision::Image& picture) const {
  picture.width = lens_.size().width;
  picture.height = lens_.size().height;
  lens_.apply(ideal.rgb, picture.rgb);
}

}  // namespace kaz::sim
