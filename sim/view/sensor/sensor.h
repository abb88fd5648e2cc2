// A camera's lens and sensor: from an ideal picture to the one that a real eye would give.
// SPDX-License-Identifier: Apache-2.0
//
// Modelled: distortion and vignetting of the lens, exposure, shot and read noise, 8-bit codes. Left
// out: rolling shutter (the paper's cameras expose all rows of a field at once), motion blur,
// interlace, the colour mosaic, blooming.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/view/renderer.h"
#include "sim/view/sensor/sensor_noise.h"
#include "vision/calibration/calibration.h"
#include "vision/calibration/remap.h"

namespace kaz::sim {

// What two cameras are by design, and how far two of a series differ from it.
struct EyeModel {
  int width = 320, height = 240;
  double rectified_view_rad = 1.3962634015954636;  // 80 degrees: of the rectified pictures
  // Horizontal view of the middle row through the lens. Wider, so that a rectified picture stays
  // full where centre and direction are off.
  double lens_view_rad = 1.4922565104551517;                // 85.5 degrees
  std::array<double, 5> distortion{-0.15, 0.022, 0, 0, 0};  // k1 k2 p1 p2 k3
  double vignetting = 0.3;  // share of the light that is lost in the corners; grows as r^2
  NoiseLaw noise;
  // One sigma each, over copies of the camera.
  double focal_spread = 0.004;          // of its value
  double centre_spread = 0.004;         // of the width
  double distortion_spread = 0.03;      // of k1, k2
  double tangential_spread = 0.0003;    // p1, p2: a lens that is not quite square to the sensor
  double direction_spread_rad = 0.004;  // about each axis: 0.23 degrees
};

// Two copies of the camera, `baseline_m` apart. The same unit gives the same copies; deviations are
// limited to 2.5 sigma, as what is further off is sorted out at the factory.
vision::StereoCalibration make_calibration(const EyeModel& model, std::uint64_t unit,
                                           double baseline_m);

class Sensor {
 public:
  enum class Eye { left = 0, right = 1 };

  // `noise_seed`: of the noise; with the eye and the number of the exposure it decides it.
  Sensor(const EyeModel& model, const vision::StereoCalibration& calibration, Eye eye,
         std::uint64_t noise_seed);

  // The pinhole whose picture expose() takes: as wide as the lens sees, with 0.92 of the pixels to an
  // angle that the rectified picture has. What is lost is less than a wide conversion lens blurs.
  const Pinhole& ideal() const { return ideal_; }
  // Where that pinhole looks: rotation from its frame to the eye's mounting.
  Eigen::Isometry3d mounting_from_optical() const;
  // `ideal`: of the size of ideal().
  void expose(const Picture& ideal, std::uint64_t exposure, Picture& picture) const;
  // Lens alone, codes rounded: for tests of geometry.
  void bend(const Picture& ideal, Picture& picture) const;

 private:
  Pinhole ideal_;
  Eigen::Matrix3d rotation_;
  vision::Remap lens_;
  NoiseRow noise_;
  std::uint64_t key_;
};

}  // namespace kaz::sim
