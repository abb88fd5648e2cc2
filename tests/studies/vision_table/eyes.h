// The simulated eyes under conditions: light, tint, exposure, noise, a head that turns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sim/view/renderer_kind.h"
#include "sim/view/sensor/sensor.h"
#include "tests/studies/vision_table/world.h"
#include "vision/calibration/rectify.h"

namespace kaz::vision_table {

struct Conditions {
  sim::Light light;
  Eigen::Array3d tint{1, 1, 1};  // of all light, red, green, blue
  double exposure = 1;           // light is multiplied by this; what passes a full well is lost
  double noise = 1;              // factor on the sigma of shot and read noise
  double turn_rad_s = 0;         // of the head about the vertical, while the picture is exposed
  double exposure_s = 0;
};

class Eyes {
 public:
  static constexpr double kBaseline_m = sim::kEyeBaseline_m;

  // Unit 2 of the eyes: lenses, mounting and noise as the simulator has them (sim/view/sensor/sensor.h).
  Eyes(int width, const Conditions& conditions);

  const vision::CameraModel& camera() const { return calibration_.rectified; }
  // The world is the foot's frame.
  vision::FrameInfo info(const Eigen::Isometry3d& eye) const;

  // Rectified. `eye`: of the left optical frame in the middle of the exposure.
  Result<vision::StereoImages> take(sim::Renderer& renderer, const sim::ScenePose& pose,
                                    const Eigen::Isometry3d& eye, std::uint64_t number) const;
  // The left picture alone.
  Result<vision::Image> take_left(sim::Renderer& renderer, const sim::ScenePose& pose,
                                  const Eigen::Isometry3d& eye, std::uint64_t number) const;
  // What an ideal left eye sees in usual light, to find where there is texture.
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

// One that has the world's scene; an error where it does not start.
Result<std::unique_ptr<sim::Renderer>> renderer_of(sim::RendererKind kind, const World& world);

}  // namespace kaz::vision_table
