// Camera model: converts the picture of an ideal pinhole camera to the picture of a camera with a real lens
// and image sensor.
// SPDX-License-Identifier: Apache-2.0
//
// The model includes lens distortion (Brown-Conrady, as in OpenCV), vignetting, exposure, shot noise, read
// noise and 8-bit codes. The model does not include motion blur, interlacing, color mosaic or blooming.
// Rolling shutter is not modeled, because the robot's cameras expose all rows of a field at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/render/renderer.h"
#include "sim/render/sensor/sensor_noise.h"
#include "vision/calibration/calibration.h"
#include "vision/calibration/remap.h"

namespace kaz::sim {

// Nominal parameters of a camera, and the tolerances of its production series.
struct EyeModel {
  int width = 320, height = 240;
  // Horizontal angle of view of the rectified pictures: 80 degrees.
  double rectified_view_rad = 1.3962634015954636;
  // Horizontal angle of view of the lens, measured along the middle row of the picture. This angle is larger
  // than the angle of the rectified pictures. Therefore rectified pictures have no empty margin, even if the
  // principal point or the direction of a camera deviates from its nominal value.
  double lens_view_rad = 1.4922565104551517;                // 85.5 degrees
  std::array<double, 5> distortion{-0.15, 0.022, 0, 0, 0};  // k1 k2 p1 p2 k3
  // Fraction of the light that is lost in the corners of the picture. The loss is proportional to the squared
  // distance from the center.
  double vignetting = 0.3;
  NoiseLaw noise;
  // Standard deviations of the parameters over the production series.
  double focal_spread = 0.004;        // relative to the focal length
  double centre_spread = 0.004;       // principal point, relative to the picture's width
  double distortion_spread = 0.03;    // k1 and k2, relative to their nominal values
  double tangential_spread = 0.0003;  // p1 and p2: tilt of the lens relative to the sensor
  // Rotation of the camera about each axis; 0.004 rad = 0.23 degrees.
  double direction_spread_rad = 0.004;
};

// Returns the calibration of two cameras from the production series that are mounted `baseline_m` apart. The
// same `unit` gives the same cameras. Deviations are clamped to 2.5 sigma, because the factory would reject
// cameras with larger deviations.
vision::StereoCalibration make_calibration(const EyeModel& model, std::uint64_t unit,
                                           double baseline_m);

class Sensor {
 public:
  enum class Eye { left = 0, right = 1 };

  // `noise_seed`, `eye` and the number of the exposure determine the noise.
  Sensor(const EyeModel& model, const vision::StereoCalibration& calibration, Eye eye,
         std::uint64_t noise_seed);

  void set_noise_seed(std::uint64_t seed);

  // Returns the pinhole camera whose picture expose() needs. This picture covers the full view of the lens.
  // This picture has 0.92 times as many pixels per radian as the rectified picture. The blur caused by the
  // lower resolution is smaller than the blur caused by a wide conversion lens.
  const vision::CameraModel& ideal() const { return ideal_; }
  // Returns the rotation from the optical frame of ideal() to the eye's mounting frame.
  Eigen::Isometry3d mounting_from_optical() const;
  // Limits the exposed pixels to the given columns of each row, for example to the pixels that a rectified
  // picture uses. Initially, all pixels are exposed.
  void limit(std::span<const vision::Remap::Columns> rows);
  // Returns the part of the ideal picture that expose() reads.
  const PicturePart& ideal_part() const { return ideal_part_; }
  // Applies lens, vignetting, noise and quantization. `ideal` must have the width and height of ideal().
  // Pixels that are not exposed keep their codes in `picture`.
  void expose(const vision::Image& ideal, std::uint64_t exposure, vision::Image& picture) const;
  // Applies only lens and vignetting, and rounds the codes. This function is for tests of the geometry.
  void bend(const vision::Image& ideal, vision::Image& picture) const;

 private:
  vision::CameraModel ideal_;
  Eigen::Matrix3d rotation_;
  vision::Remap lens_;
  std::vector<vision::Remap::Columns> rows_;  // exposed columns in each row
  PicturePart ideal_part_;
  NoiseRow noise_;
  Eye eye_;
  std::uint64_t key_ = 0;
};

}  // namespace kaz::sim
