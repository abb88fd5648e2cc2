// The simulated eyes under varied conditions: light, tint, exposure, noise, and a turning head.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sim/render/renderer_kind.h"
#include "sim/render/sensor/sensor.h"
#include "tests/studies/vision_table/world.h"
#include "vision/calibration/rectify.h"

namespace kaz::vision_table {

struct Conditions {
  sim::Light light;
  Eigen::Array3d tint{1, 1, 1};  // factors on red, green and blue light
  double exposure = 1;           // factor on the light; saturates at the full well
  double noise = 1;              // factor on the sigma of shot and read noise
  double turn_rad_s = 0;         // rate of the head about the vertical during the exposure
  double exposure_s = 0;         // duration of the exposure
};

class Eyes {
 public:
  static constexpr double kBaseline_m = sim::kEyeBaseline_m;

  // Unit number 2 of the eyes, with the simulator's lenses, mounting and noise (sim/render/sensor/sensor.h).
  Eyes(int width, const Conditions& conditions);

  const vision::CameraModel& camera() const { return calibration_.rectified; }
  // Returns frame information in which the foot's frame is the world.
  vision::FrameInfo info(const Eigen::Isometry3d& eye) const;

  // Returns a rectified pair. `eye`: pose of the left optical frame in the middle of the exposure. `number`:
  // number of the exposure, for its noise.
  Result<vision::StereoImages> take(sim::Renderer& renderer, const sim::ScenePose& pose,
                                    const Eigen::Isometry3d& eye, std::uint64_t number) const;
  // Returns only the left picture.
  Result<vision::Image> take_left(sim::Renderer& renderer, const sim::ScenePose& pose,
                                  const Eigen::Isometry3d& eye, std::uint64_t number) const;
  // Returns the picture of an ideal left eye in default light, to find texture.
  Result<vision::Image> ideal(sim::Renderer& renderer, const sim::ScenePose& pose,
                              const Eigen::Isometry3d& eye) const;

 private:
  Result<vision::Image> raw(sim::Renderer& renderer, const sim::ScenePose& pose,
                            const sim::Sensor& sensor, const Eigen::Isometry3d& eye,
                            double baseline_m, std::uint64_t number) const;

  Conditions conditions_;
  vision::StereoCalibration calibration_;
  sim::Sensor left_, right_;
  vision::Rectifier rectifier_;
};

// Creates a renderer with the scene of `world`. Errors: it does not start.
Result<std::unique_ptr<sim::Renderer>> renderer_of(sim::RendererKind kind, const World& world);

}  // namespace kaz::vision_table
