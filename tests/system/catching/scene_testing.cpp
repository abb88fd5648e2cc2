// Writes the world, puts host and simulation together, runs the behavior.
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/catching/scene_testing.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include "host/behavior/vision.h"
#include "host/camera/capture.h"
#include "sim/body/description/robot_model.h"
#include "tools/lockstep/lockstep.h"
#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::catching {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d, Eigen::Vector3d;

// A file that goes with the object.
class WorldFile {
 public:
  explicit WorldFile(const std::string& text) {
    static int number = 0;
    path_ = fs::temp_directory_path() /
            ("kaz-catching-" + std::to_string(getpid()) + "-" + std::to_string(number++) + ".sdf");
    std::ofstream(path_) << text;
  }
  WorldFile(const WorldFile&) = delete;
  WorldFile& operator=(const WorldFile&) = delete;
  ~WorldFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  std::string path() const { return path_; }

 private:
  fs::path path_;
};

void add_ball(std::ostream& out, const std::string& name, const Vector2d& at, const Scene& scene,
              const char* color, const std::vector<Kick>& kicks) {
  const double r = scene.radius, mass = 0.015 * std::pow(r / 0.020, 3), moment = 0.4 * mass * r * r;
  out << "<model name=\"" << name << "\"><pose>" << at.x() << " " << at.y() << " " << r
      << " 0 0 0</pose><link name=\"" << name << "\"><inertial><mass>" << mass
      << "</mass><inertia><ixx>" << moment << "</ixx><iyy>" << moment << "</iyy><izz>" << moment
      << "</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
      << "<collision name=\"skin\"><geometry><sphere><radius>" << r
      << "</radius></sphere></geometry><surface><friction><ode><mu>1.0</mu></ode></friction>"
      << "<kaz:rolling_resistance metres=\"" << scene.rolling_resistance
      << "\"/></surface></collision><visual name=\"paint\"><geometry><sphere><radius>" << r
      << "</radius></sphere></geometry><material><diffuse>" << color
      << "</diffuse></material></visual></link>";
  for (const Kick& kick : kicks)
    out << "<kaz:kick time=\"" << kick.time_s << "\" velocity=\"" << kick.velocity.x() << " "
        << kick.velocity.y() << " " << kick.velocity.z() << "\"/>";
  out << "</model>\n";
}

std::string world_of(const Scene& scene) {
  std::ostringstream out;
  out << R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="catching">
<model name="floor"><static>true</static><link name="slab"><collision name="hull">
<geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision>
<visual name="top"><geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<material><diffuse>0.72 0.60 0.44 1</diffuse></material><kaz:texture name="wood"/></visual></link></model>
)";
  if (scene.has_ball) add_ball(out, "ball", scene.ball, scene, "0.85 0.06 0.05 1", scene.kicks);
  for (std::size_t i = 0; i < scene.other_balls.size(); ++i)
    add_ball(out, "other" + std::to_string(i), scene.other_balls[i], scene, "0.06 0.16 0.75 1", {});
  out << "</world></sdf>\n";
  return out.str();
}

// What was exposed while it is frozen never comes.
class FreezingCamera final : public vision::Camera {
 public:
  FreezingCamera(vision::Camera& camera, const Scene& scene)
      : camera_(camera),
        from_(from_seconds(scene.frozen_from_s)),
        until_(from_seconds(scene.frozen_from_s + scene.frozen_for_s)) {}
  const vision::CameraModel& model() const override { return camera_.model(); }
  Result<std::optional<vision::StereoPair>> poll() override {
    for (;;) {
      auto pair = camera_.poll();
      if (!pair || !*pair || (*pair)->info.exposure < from_ || (*pair)->info.exposure >= until_)
        return pair;
    }
  }

 private:
  vision::Camera& camera_;
  Time from_, until_;
};

class Onlooker final : public behavior::Sink {
 public:
  Onlooker(sim::Simulation& simulation, const Scene& scene, Ending& ending)
      : simulation_(simulation), scene_(scene), ending_(ending) {}
  void phase(Time, std::string_view, std::string_view phase) override {
    if (!scene_.fault_phase.empty() && phase == scene_.fault_phase && !ending_.did(phase)) {
      const auto fault = faults::parse("at " + std::to_string(seconds(simulation_.time())) + " s " +
                                       scene_.fault_then);
      if (fault) simulation_.add_fault(*fault);
    }
    ending_.phases.emplace_back(phase);
  }
  void cycle(const behavior::CycleRow& row) override {
    const Eigen::Isometry3d trunk = simulation_.world().link_pose("trunk");
    if (trunk.linear()(2, 2) < 0.3 || trunk.translation().z() < 0.07) ending_.fell = true;
    const double t = seconds(row.time) - scene_.frozen_from_s;
    // It may end its step: to a stand takes a cycle and a half of 1 s.
    if (scene_.frozen_for_s > 0 && t > 0.5 && t < scene_.frozen_for_s) {
      if (!began_) start_ = trunk.translation().head<2>();
      began_ = true;
      ending_.walked_while_frozen = (trunk.translation().head<2>() - start_).norm();
    }
  }

 private:
  sim::Simulation& simulation_;
  const Scene& scene_;
  Ending& ending_;
  bool began_ = false;
  Vector2d start_{0, 0};
};

}  // namespace

bool Ending::did(std::string_view phase) const {
  return times(phase) > 0;
}
int Ending::times(std::string_view phase) const {
  return static_cast<int>(std::count(phases.begin(), phases.end(), phase));
}

Result<Ending> play(const Scene& scene) {
  const WorldFile world(world_of(scene));
  const std::string robot_folder = KAZ_ROBOT;
  sim::SimulationOptions options;
  options.mcu = scene.mcu;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.seed = scene.seed;
  options.world_path = world.path();
  options.robot_path = robot_folder + "/kaz.urdf";
  options.camera_path = robot_folder + "/camera.json";
  options.imu = true;
  options.eyes = scene.eyes;
  auto simulation = KAZ_TRY(sim::Simulation::create(options));
  for (const std::string& line : scene.faults) {
    const auto fault = KAZ_TRY(faults::parse(line));
    simulation->add_fault(fault);
  }
  lockstep::LockstepClock clock(*simulation);
  lockstep::LockstepLink link(*simulation);
  auto robot = KAZ_TRY(host::Robot::connect(link, clock));
  lockstep::LockstepCamera eyes(*simulation);
  FreezingCamera camera(eyes, scene);
  host::Capture capture(camera, robot);
  vision::Pipeline pipeline({vision::Pace::lockstep, from_seconds(simulation->camera().latency_s)});
  vision::BallOptions ball;
  ball.radius_m = scene.radius;
  KAZ_TRY(pipeline.add(vision::make_color_module(ball)));
  behavior::PipelineVision seeing(capture, pipeline);

  Ending ending;
  Onlooker onlooker(*simulation, scene, ending);
  const auto behavior = behavior::find_behavior(scene.behavior);
  if (!behavior) return tl::unexpected(behavior.error());
  const auto values = KAZ_TRY(behavior::OptionValues::parse(behavior->options, scene.options));
  behavior::Context context{robot, robot.clock(), &seeing, onlooker, values, scene.seed};
  context.ball_radius_m = scene.radius;
  auto outcome = KAZ_TRY(behavior->run(context));
  ending.outcome = std::move(outcome);
  ending.seconds = seconds(simulation->time());
  if (scene.has_ball) ending.ball = simulation->world().object_position("ball").value();
  return ending;
}

}  // namespace kaz::catching
