// `kaz eyes`: what both eyes and an onlooker see, as pictures.
// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/draw_eyes.h"

#include <cstdio>

#include "sim/render/camera.h"
#include "sim/render/sensor/sensor.h"
#include "tools/base/output.h"
#include "tools/drawing/figure.h"
#include "vision/calibration/rectify.h"

namespace kaz::tools {
namespace {

Result<vision::Image> outside(sim::Simulation& simulation) {
  sim::View view;
  view.camera = sim::camera_of_view(960, 720, 0.6);
  view.world_from_optical = sim::look_at({0.85, -0.75, 0.5}, {0.16, 0, 0.13});
  view.samples_per_axis = 2;
  return simulation.picture(view, simulation.world().pose());
}

// One eye: what a pinhole at its place would give, and what its lens and sensor make of it.
struct EyePictures {
  vision::Image ideal, raw;
};
Result<EyePictures> look(sim::Simulation& simulation, const sim::CameraFile& camera,
                         sim::Sensor::Eye eye, std::uint64_t seed) {
  const sim::Sensor sensor(camera.eye, camera.calibration(), eye, seed);
  const sim::ScenePose pose = simulation.world().pose();
  sim::View view;
  view.world_from_optical =
      simulation.world().link_pose(eye == sim::Sensor::Eye::left ? "left_eye" : "right_eye");
  view.camera = camera.model();
  auto ideal = KAZ_TRY(simulation.picture(view, pose));
  view.world_from_optical = view.world_from_optical * sensor.mounting_from_optical();
  view.camera = sensor.ideal();
  const auto wide = KAZ_TRY(simulation.picture(view, pose));
  vision::Image raw;
  sensor.expose(wide, 0, raw);
  return EyePictures{std::move(ideal), std::move(raw)};
}

}  // namespace

Result<bool> draw_eyes(EyesOptions arguments) {
  const auto folder = KAZ_TRY(OutputFolder::open(
      arguments.out, {"eyes",
                      {"outside.png", "left_ideal.png", "right_ideal.png", "left_raw.png",
                       "right_raw.png", "left_rectified.png", "right_rectified.png", "eyes.png"}}));
  auto simulation = KAZ_TRY(make_simulation(arguments.backend, sim::FramePolicy::wait));
  if (!simulation->has_eyes()) return tl::unexpected(sim::Simulation::no_eyes());
  KAZ_TRY(folder.clear());
  sim::CameraFile camera = simulation->camera();
  camera.ideal = false;
  auto left = KAZ_TRY(look(*simulation, camera, sim::Sensor::Eye::left, arguments.backend.seed));
  auto right = KAZ_TRY(look(*simulation, camera, sim::Sensor::Eye::right, arguments.backend.seed));
  const auto onlooker = KAZ_TRY(outside(*simulation));
  vision::StereoImages rectified;
  vision::Rectifier(camera.calibration()).rectify({left.raw, right.raw}, rectified);

  const figure::Panel panels[] = {
      {onlooker, "from outside"},
      {left.raw, "left eye: lens and noise"},
      {right.raw, "right eye: lens and noise"},
      {left.ideal, "left eye, ideal"},
      {rectified.left, "left eye, rectified"},
      {rectified.right, "right eye, rectified"},
  };
  const struct {
    const char* name;
    const vision::Image& image;
  } files[] = {{"outside.png", onlooker},
               {"left_ideal.png", left.ideal},
               {"right_ideal.png", right.ideal},
               {"left_raw.png", left.raw},
               {"right_raw.png", right.raw},
               {"left_rectified.png", rectified.left},
               {"right_rectified.png", rectified.right}};
  for (const auto& file : files) {
    KAZ_TRY(figure::write_png(folder.path(file.name), file.image));
  }
  KAZ_TRY(figure::write_png(folder.path("eyes.png"), figure::compose(panels, 3, 300)));
  std::printf("pictures in %s: eyes.png shows all of these pictures\n", folder.folder().c_str());
  return true;
}

}  // namespace kaz::tools
