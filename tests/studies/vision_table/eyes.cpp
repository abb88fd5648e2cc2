// Renders, mixes, exposes, rectifies.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/eyes.h"

#include <algorithm>
#include <cmath>

namespace kaz::vision_table {
namespace {

sim::EyeModel model_of(int width, const Conditions& conditions) {
  sim::EyeModel model;
  model.width = width;
  model.height = width * 3 / 4;
  model.noise.exposure = conditions.exposure;
  // Variance in light: 255^2 / full_well times code^2, and its square times read_noise^2.
  model.noise.full_well_e /= conditions.noise * conditions.noise;
  model.noise.read_noise_e /= conditions.noise;
  return model;
}

// About the vertical axis of the world through the eye: the neck is some centimetres behind it,
// which moves the eye by less than 2 mm in the longest exposure here.
Eigen::Isometry3d turned(const Eigen::Isometry3d& eye, double angle_rad) {
  Eigen::Isometry3d pose = eye;
  pose.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()) * eye.linear();
  return pose;
}

}  // namespace

Eyes::Eyes(int width, const Conditions& conditions)
    : conditions_(conditions),
      calibration_(sim::make_calibration(model_of(width, conditions), 2, kBaseline_m)),
      left_(model_of(width, conditions), calibration_, sim::Sensor::Eye::left, 1),
      right_(model_of(width, conditions), calibration_, sim::Sensor::Eye::right, 1),
      rectifier_(calibration_) {}

vision::FrameInfo Eyes::info(const Eigen::Isometry3d& eye) const {
  vision::FrameInfo info;
  info.camera = camera();
  info.posture_known = true;
  info.foot_from_eye = eye;
  return info;
}

Result<vision::Image> Eyes::raw(sim::Renderer& renderer, const sim::ScenePose& pose,
                                const sim::Sensor& sensor, const Eigen::Isometry3d& eye,
                                double baseline_m, std::uint64_t number) const {
  const double turn = conditions_.turn_rad_s * conditions_.exposure_s;
  // A pixel from one to the next; the lens blurs by as much.
  const int parts = 1 + static_cast<int>(std::ceil(std::abs(turn) * sensor.ideal().fx));
  std::vector<double> light;
  vision::Image ideal;
  for (int i = 0; i < parts; ++i) {
    const double angle = parts > 1 ? turn * ((i + 0.5) / parts - 0.5) : 0;
    sim::View view;
    view.camera = sensor.ideal();
    view.light = conditions_.light;
    view.world_from_optical = turned(eye, angle) * Eigen::Translation3d(baseline_m, 0, 0) *
                              sensor.mounting_from_optical();
    KAZ_TRY(renderer.render(pose, view, ideal));
    light.resize(ideal.rgb.size());
    for (std::size_t k = 0; k < light.size(); ++k) light[k] += 1.0 * ideal.rgb[k] * ideal.rgb[k];
  }
  if (parts > 1 || !(conditions_.tint == 1).all()) {
    for (std::size_t k = 0; k < light.size(); ++k) {
      const double code = std::sqrt(light[k] / parts * conditions_.tint[static_cast<int>(k % 3)]);
      ideal.rgb[k] = static_cast<std::uint8_t>(std::lround(std::min(code, 255.0)));
    }
  }
  vision::Image exposed;
  sensor.expose(ideal, number, exposed);
  return exposed;
}

Result<vision::StereoImages> Eyes::take(sim::Renderer& renderer, const sim::ScenePose& pose,
                                        const Eigen::Isometry3d& eye, std::uint64_t number) const {
  auto left = KAZ_TRY(raw(renderer, pose, left_, eye, 0, number));
  auto right = KAZ_TRY(raw(renderer, pose, right_, eye, kBaseline_m, number));
  vision::StereoImages rectified;
  rectifier_.rectify({std::move(left), std::move(right)}, rectified);
  return rectified;
}

Result<vision::Image> Eyes::take_left(sim::Renderer& renderer, const sim::ScenePose& pose,
                                      const Eigen::Isometry3d& eye, std::uint64_t number) const {
  auto left = raw(renderer, pose, left_, eye, 0, number);
  if (!left) return left;
  vision::StereoImages both, rectified;
  both.right = *left;
  both.left = std::move(*left);
  rectifier_.rectify(both, rectified);
  return std::move(rectified.left);
}

Result<vision::Image> Eyes::ideal(sim::Renderer& renderer, const sim::ScenePose& pose,
                                  const Eigen::Isometry3d& eye) const {
  sim::View view;
  view.camera = camera();
  view.world_from_optical = eye;
  vision::Image picture;
  KAZ_TRY(renderer.render(pose, view, picture));
  return picture;
}

Result<std::unique_ptr<sim::Renderer>> renderer_of(sim::RendererKind kind, const World& world) {
  auto renderer = sim::maker_of(kind)();
  if (!renderer) return renderer;
  KAZ_TRY((*renderer)->set_scene(world.scene.scene));
  return renderer;
}

}  // namespace kaz::vision_table
