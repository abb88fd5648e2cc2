// Draws the picture from which an episode's colour is learned, and learns it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/learned_color.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "sim/render/camera.h"
#include "sim/render/sensor/sensor.h"
#include "tools/base/paths.h"
#include "tools/eval/dice.h"
#include "tools/run/backend.h"

namespace kaz::tools {
namespace {

constexpr double kPi = std::numbers::pi;
// Side of the marked square, of the ball's radius: well inside of it, as one marks who sees the ball.
constexpr double kMarked = 1.1;

Scenario lesson_of(const Scenario& episode) {
  const Variation usual;
  Dice dice(episode.seed, Draw::lamp);  // apart from the episode's own draw
  Scenario lesson;
  lesson.seed = episode.seed;
  lesson.ball_color = episode.ball_color;
  lesson.ball_radius_m = episode.ball_radius_m;
  lesson.ball_x_m = 0.28;
  lesson.ball_y_m = 0.05;
  lesson.floor = episode.floor == "carpet" ? "wood" : "carpet";
  lesson.lamp_azimuth_rad = episode.lamp_azimuth_rad + dice(kPi / 2, 3 * kPi / 2);
  lesson.lamp_height_rad = dice(usual.lamp_height_deg.min, usual.lamp_height_deg.max) * kPi / 180;
  lesson.lamp = dice(usual.lamp.min, usual.lamp.max);
  lesson.shade = dice(usual.shade.min, usual.shade.max);
  return lesson;
}

// By the left eye, the head turned to the ball.
Result<vision::Image> take_picture(sim::Simulation& simulation, const Scenario& lesson,
                                   const BackendOptions& backend) {
  const sim::CameraFile& camera = simulation.camera();
  const Eigen::Vector3d eye = simulation.world().link_pose("left_eye").translation();
  const sim::ScenePose pose = simulation.world().pose();
  sim::View view;
  view.world_from_optical =
      sim::look_at(eye, {lesson.ball_x_m, lesson.ball_y_m, lesson.ball_radius_m});
  view.camera = camera.model();
  vision::Image picture;
  if (backend.eyes == sim::EyeKind::ideal) {
    picture = KAZ_TRY(simulation.picture(view, pose));
  } else {
    const sim::Sensor sensor(camera.eye, camera.calibration(), sim::Sensor::Eye::left, lesson.seed);
    view.camera = sensor.ideal();
    const auto wide = KAZ_TRY(simulation.picture(view, pose));
    sensor.expose(wide, 0, picture);
  }
  return picture;
}

// The head is turned to the ball, so that it is in the picture's middle.
vision::PictureRegion mark(const vision::Image& picture, const sim::Simulation& simulation,
                           const Scenario& lesson) {
  const Eigen::Vector3d to_ball =
      Eigen::Vector3d(lesson.ball_x_m, lesson.ball_y_m, lesson.ball_radius_m) -
      simulation.world().link_pose("left_eye").translation();
  const double radius_px = simulation.camera().model().fx * lesson.ball_radius_m / to_ball.norm();
  const int side = std::max(5, static_cast<int>(kMarked * radius_px));
  return {(picture.width - side) / 2, (picture.height - side) / 2, side, side};
}

}  // namespace

Result<ColorLesson> draw_color_lesson(const Scenario& episode, const BackendOptions& backend) {
  ColorLesson lesson{lesson_of(episode), {}, {}};
  const auto robot = KAZ_TRY(data_file("robot/kaz/kaz.urdf"));
  const auto files =
      KAZ_TRY(scenario_files(lesson.scenario, std::filesystem::path(robot).parent_path().string()));
  BackendOptions options;
  options.mcu = sim::McuKind::native;
  options.world = files.world();
  options.robot_file = files.robot();
  options.seed = lesson.scenario.seed;
  options.copy_eyes(backend);
  auto simulation = KAZ_TRY(make_simulation(options, sim::FramePolicy::wait));
  lesson.picture = KAZ_TRY(take_picture(*simulation, lesson.scenario, options));
  lesson.region = mark(lesson.picture, *simulation, lesson.scenario);
  return lesson;
}

Result<vision::ColorRange> learned_ball_color(const Scenario& episode,
                                              const BackendOptions& backend) {
  const auto lesson = KAZ_TRY(draw_color_lesson(episode, backend));
  auto learned = vision::learn_color(lesson.picture, lesson.region);
  if (!learned)
    return fail(learned.error().fault, "cannot learn the color of the " + episode.ball_color +
                                           " ball: " + learned.error().message);
  return learned->range;
}

}  // namespace kaz::tools
