// The virtual robot in its crouch looks around, and slow vision makes a map of it, twice.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/figure7/sweep.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "host/camera/capture.h"
#include "host/motion/gait.h"
#include "host/robot/kinematics.h"
#include "host/robot/robot.h"
#include "shared/base/angle.hpp"
#include "tools/lockstep/lockstep.h"
#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::figure7 {
namespace {

using Eigen::Isometry3d;
using host::JointAngles;

constexpr Time kControlCycle = std::chrono::milliseconds(10);
// From the arrival of a pair to the arrival of its result.
constexpr Time kDelay = std::chrono::milliseconds(300);
// The head sweeps from side to side at each of these angles.
constexpr double kTilts_deg[] = {35, 20};
constexpr double kPan_deg = 50, kSpeed_deg_per_s = 60;
// Into the crouch, and until it rests there; the eyes to another tilt, and until they rest; after the sweeps.
constexpr double kStand_s = 2.0, kStood_s = 2.6, kTilted_s = 0.4, kTilt_s = 0.5, kRest_s = 0.1;

class Run {
 public:
  explicit Run(std::unique_ptr<sim::Simulation> simulation)
      : simulation_(std::move(simulation)), clock_(*simulation_), link_(*simulation_) {}

  Result<Sweep> run() {
    auto with = KAZ_TRY(map::LocalMap::make()), without = KAZ_TRY(map::LocalMap::make());
    boxes_ = boxes_of(simulation_->world().scene());
    out_.emplace(Sweep{std::move(with), std::move(without), {}});
    KAZ_TRY(stand());
    KAZ_TRY(look_around());
    return std::move(*out_);
  }

 private:
  Result<void> stand() {
    auto robot = KAZ_TRY(host::Robot::connect(link_, clock_));
    robot_.emplace(std::move(robot));
    // Those of the behaviors. With the body's gain the light head hunts across the gear's gap, by a degree.
    constexpr auto kNeck = 1U << host::neck_pan | 1U << host::neck_tilt;
    constexpr auto kHands = 1U << host::l_hand | 1U << host::r_hand;
    KAZ_TRY(robot_->set_gains(kNeck, {.kp_per_rad = 12, .kd_s_per_rad = 0.15}));
    KAZ_TRY(robot_->set_gains(host::kAllJoints & ~kNeck & ~kHands,
                              {.kp_per_rad = 20, .kd_s_per_rad = 0.15}));
    KAZ_TRY(robot_->enable(host::kAllJoints));
    goal_ = motion::home();
    goal_[host::neck_pan] = kPan_deg * kDegree;
    goal_[host::neck_tilt] = kTilts_deg[0] * kDegree;
    KAZ_TRY(send(kStand_s));
    return robot_->clock().sleep_until(clock_.now() + from_seconds(kStood_s));
  }

  Result<void> send(double duration_s) {
    std::array<host::JointTarget, KZ_JOINTS> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto joint = static_cast<std::size_t>(j);
      targets[joint] = {j, goal_[joint]};
    }
    return robot_->set_targets(targets, from_seconds(duration_s));
  }

  Result<void> look_around() {
    // The map's frame is the supporting foot's as it stands now; it does not move any more.
    const Isometry3d world_from_sole = simulation_->world().link_pose("l_ankle_pitch") *
                                       Eigen::Translation3d(0, 0, -host::kLeg.ankle_height);
    const Isometry3d foot_from_world = world_from_sole.inverse();
    out_->edges = edge_points(boxes_, foot_from_world);
    for (Box& box : boxes_) box.pose = foot_from_world * box.pose;
    camera_.emplace(*simulation_);
    capture_.emplace(*camera_, *robot_);
    KAZ_TRY(begin_vision());
    double side = 1;
    for (const double tilt : kTilts_deg) {
      goal_[host::neck_tilt] = tilt * kDegree;
      KAZ_TRY(go(kTilted_s, kTilt_s));
      side = -side;
      goal_[host::neck_pan] = side * kPan_deg * kDegree;
      const double lasts = 2 * kPan_deg / kSpeed_deg_per_s;
      KAZ_TRY(go(lasts, lasts));
    }
    return go(kRest_s, kRest_s + seconds(kDelay));  // for results still in progress
  }

  // Depth, planes and the floor's edges, done kDelay after the pair has come.
  Result<void> begin_vision() {
    vision::PipelineOptions options;
    options.camera_latency = from_seconds(simulation_->camera().latency_s);
    pipeline_.emplace(options);
    KAZ_TRY(pipeline_->add(vision::make_depth_module({})));
    KAZ_TRY(pipeline_->add(vision::make_planes_module({})));
    KAZ_TRY(pipeline_->add(
        vision::make_floor_module({}, kDelay - vision::kDepthLatency - vision::kPlanesLatency)));
    return pipeline_->subscribe<vision::PlaneSegments>(
        "floor", [this](const vision::Frame& frame, const auto* planes, const Error* error) {
          if (!failed_) failed_ = error != nullptr ? *error : enter(frame, *planes);
        });
  }

  // Towards the goal in `duration`; sees for `lasts`.
  Result<void> go(double duration_s, double lasts_s) {
    KAZ_TRY(send(duration_s));
    const Time end = clock_.now() + from_seconds(lasts_s);
    Time next_cycle = clock_.now();
    while (next_cycle < end) {
      next_cycle += kControlCycle;
      KAZ_TRY(robot_->clock().sleep_until(next_cycle));
      const auto state = KAZ_TRY(robot_->state());
      newest_ = state.angle;
      while (true) {
        auto next = KAZ_TRY(capture_->poll());
        if (!next) break;
        pipeline_->submit(std::move(*next));
      }
      pipeline_->poll(clock_.now());
      if (failed_) return tl::unexpected(*failed_);
    }
    return {};
  }

  // A picture's floor has come, kDelay late.
  std::optional<Error> enter(const vision::Frame& frame, const vision::PlaneSegments& planes) {
    const vision::FrameInfo& then = frame.info();
    if (out_->pictures == 0 && !then.posture_known) return std::nullopt;  // before the first state
    const auto& depth = frame.of<vision::DepthImage>("depth");
    auto done = out_->with.update(planes, depth, then);
    vision::FrameInfo now = then;
    now.foot_from_eye = host::foot_from_eye(newest_);
    if (done) done = out_->without.update(planes, depth, now);
    if (!done) return done.error();
    ++out_->pictures;
    out_->without_floor += planes.floor_found() ? 0 : 1;
    look(then.camera, then.foot_from_eye, boxes_, out_->edges);
    const double pan = then.joint_rad[host::neck_pan], passed = seconds(then.exposure - before_);
    if (out_->pictures > 1)
      out_->fastest_rad_per_s = std::max(out_->fastest_rad_per_s, std::abs(pan - pan_) / passed);
    pan_ = pan;
    before_ = then.exposure;
    return std::nullopt;
  }

  std::unique_ptr<sim::Simulation> simulation_;
  lockstep::LockstepClock clock_;
  lockstep::LockstepLink link_;
  std::vector<Box> boxes_;
  std::optional<Sweep> out_;
  std::optional<host::Robot> robot_;
  std::optional<lockstep::LockstepCamera> camera_;
  std::optional<host::Capture> capture_;
  std::optional<vision::Pipeline> pipeline_;
  std::optional<Error> failed_;
  JointAngles goal_{}, newest_{};
  double pan_ = 0;  // at the exposure before
  Time before_{};
};

}  // namespace

Result<Sweep> sweep(const std::string& world, const std::string& robot_folder,
                    const std::string& image) {
  sim::SimulationOptions options;
  options.mcu = sim::McuKind::h8;
  options.image_path = image;
  options.world_path = world;
  options.robot_path = robot_folder + "/kaz.urdf";
  options.camera_path = robot_folder + "/camera.json";
  options.eyes = sim::EyeKind::real;
  options.eye_width = 320;
  return Run(KAZ_TRY(sim::Simulation::create(options))).run();
}

}  // namespace kaz::figure7
