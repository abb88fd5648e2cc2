// Renderer, sensor and rectification one after the other.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/sensor/real_eye.h"

#include "shared/base/profile.hpp"
#include "vision/calibration/rectify.h"

namespace kaz::sim {

RealEye::RealEye(const EyeModel& model, const vision::StereoCalibration& calibration,
                 Sensor::Eye eye, std::uint64_t noise_seed)
    : sensor_(model, calibration, eye, noise_seed),
      rectification_(vision::rectification(
          calibration, eye == Sensor::Eye::left ? calibration.left : calibration.right)) {
  sensor_.limit(rectification_.sources(rectification_.all_rows()));
}

View RealEye::view(const Eigen::Isometry3d& world_from_eye) const {
  View view;
  view.camera = sensor_.ideal();
  view.world_from_optical = world_from_eye * sensor_.mounting_from_optical();
  view.part = sensor_.ideal_part();
  return view;
}

Result<void> RealEye::take(Renderer& renderer, const ScenePose& pose, const View& view,
                           std::uint64_t exposure, vision::Image& rectified) {
  {
    const ProfileScope part("drawing");
    KAZ_TRY(renderer.render(pose, view, ideal_));
  }
  {
    const ProfileScope part("lens, exposure, noise");
    sensor_.expose(ideal_, exposure, raw_);
  }
  const ProfileScope part("rectification");
  rectified.width = rectification_.size().width;
  rectified.height = rectification_.size().height;
  rectification_.apply(raw_.rgb, rectified.rgb);
  return {};
}

}  // namespace kaz::sim
