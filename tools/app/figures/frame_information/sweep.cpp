// The virtual robot in its crouch looks around, and slow vision makes a map of it, twice.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/frame_information/sweep.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "host/camera/capture.h"
#include "host/link/interruptible.h"
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
using Eigen::Vector3d;
using host::JointAngles;

constexpr Time kControlCycle = std::chrono::milliseconds(10);
// Into the crouch, and until it rests there; the eyes to another tilt, and until they rest; after the sweeps.
constexpr double kStand_s = 2.0, kStood_s = 2.6, kTilted_s = 0.4, kTilt_s = 0.5, kRest_s = 0.1;

int floor_cells(const map::LocalMap& map) {
  int count = 0;
  for (int x = 0; x < map.cells(); ++x) {
    for (int y = 0; y < map.cells(); ++y)
      count += map.cell(x, y).state == map::CellState::floor ? 1 : 0;
  }
  return count;
}

double floor_share(const vision::PlaneSegments& planes) {
  const auto floor = std::ranges::count_if(planes.label, [&](std::uint8_t label) {
    return label != 0 && planes.segments[label - 1U].floor;
  });
  return static_cast<double>(floor) / static_cast<double>(planes.label.size());
}

class Run {
 public:
  explicit Run(const Options& options) : options_(options) {}

  Result<Sweep> run() {
    auto done = start();
    if (done) done = look_around();
    if (!done) return tl::unexpected(done.error());
    if (out_->swept.empty())
      return fail(Fault::failed, "no picture with a known posture was received");
    return std::move(*out_);
  }

 private:
  Result<void> start() {
    auto with = map::LocalMap::make(options_.map), without = map::LocalMap::make(options_.map);
    if (!with) return tl::unexpected(with.error());
    sim::SimulationOptions sim;
    sim.mcu = options_.mcu;
    sim.image_path = options_.image_path;
    sim.world_path = options_.world;
    sim.robot_path = options_.robot_folder + "/kaz.urdf";
    sim.camera_path = options_.robot_folder + "/camera.json";
    sim.eyes = options_.eyes;
    sim.renderer = sim::maker_of(options_.renderer);
    sim.sensors = sim::sensor_switches(options_.sensors);
    sim.eye_width = options_.eye_width;
    sim.seed = options_.seed;
    auto made = KAZ_TRY(sim::Simulation::create(sim));
    simulation_ = std::move(made);
    auto boxes = boxes_of(simulation_->world().scene());
    if (boxes.empty())
      return fail(Fault::usage, options_.world + ": has no stationary box; give a world like yard");
    out_.emplace(
        Sweep{std::move(*with), std::move(*without), {}, std::move(boxes), {}, 0, 0, 0, {}});
    raw_clock_.emplace(*simulation_);
    raw_link_.emplace(*simulation_);
    clock_.emplace(*raw_clock_, options_.interrupt);
    link_.emplace(*raw_link_, *raw_clock_, options_.interrupt);
    auto robot = KAZ_TRY(host::Robot::connect(*link_, *clock_));
    robot_.emplace(std::move(robot));
    // Those of the behaviors. With the body's gain the light head hunts across the gear's gap, by a degree.
    constexpr auto kNeck = 1U << host::neck_pan | 1U << host::neck_tilt;
    constexpr auto kHands = 1U << host::l_hand | 1U << host::r_hand;
    auto done = robot_->set_gains(kNeck, {.kp_per_rad = 12, .kd_s_per_rad = 0.15});
    if (done) {
      done = robot_->set_gains(host::kAllJoints & ~kNeck & ~kHands,
                               {.kp_per_rad = 20, .kd_s_per_rad = 0.15});
    }
    if (done) done = robot_->enable(host::kAllJoints);
    goal_ = motion::home();
    goal_[host::neck_pan] = options_.pan_deg * kDegree;
    if (!options_.tilts_deg.empty()) goal_[host::neck_tilt] = options_.tilts_deg[0] * kDegree;
    if (done) done = send(kStand_s);
    if (done) done = robot_->clock().sleep_until(clock_->now() + from_seconds(kStood_s));
    return done;
  }

  // From the robot's start to the last result.
  Time whole() const {
    const double one = kTilt_s + 2 * options_.pan_deg / options_.speed_deg_per_s;
    return from_seconds(kStood_s + static_cast<double>(options_.tilts_deg.size()) * one + kRest_s) +
           options_.delay;
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
    out_->edges = edge_points(out_->boxes, foot_from_world);
    for (Box& box : out_->boxes) box.pose = foot_from_world * box.pose;
    camera_.emplace(*simulation_);
    capture_.emplace(*camera_, *robot_);
    if (auto vision = begin_vision(); !vision) return vision;
    double side = 1;
    for (std::size_t k = 0; k < options_.tilts_deg.size(); ++k) {
      goal_[host::neck_tilt] = options_.tilts_deg[k] * kDegree;
      if (auto set = go(kTilted_s, kTilt_s); !set) return set;
      side = -side;
      goal_[host::neck_pan] = side * options_.pan_deg * kDegree;
      const double lasts = 2 * options_.pan_deg / options_.speed_deg_per_s;
      if (auto swept = go(lasts, lasts); !swept) return swept;
    }
    return go(kRest_s, kRest_s + seconds(options_.delay));  // for results still in progress
  }

  // Depth, planes and the floor's edges, done `delay` after the pair has come.
  Result<void> begin_vision() {
    vision::PipelineOptions options;
    options.camera_latency = from_seconds(simulation_->camera().latency_s);
    pipeline_.emplace(options);
    const Time rest = options_.delay - vision::kDepthLatency - vision::kPlanesLatency;
    auto done = pipeline_->add(vision::make_depth_module({}));
    if (done) done = pipeline_->add(vision::make_planes_module({}));
    if (done) done = pipeline_->add(vision::make_floor_module({}, rest));
    if (!done) return done;
    return pipeline_->subscribe<vision::PlaneSegments>(
        "floor", [this](const vision::Frame& frame, const auto* planes, const Error* error) {
          if (!failed_) failed_ = error != nullptr ? *error : enter(frame, *planes);
        });
  }

  // Towards the goal in `duration`; sees for `lasts`.
  Result<void> go(double duration_s, double lasts_s) {
    if (auto sent = send(duration_s); !sent) return sent;
    const Time end = robot_->clock().now() + from_seconds(lasts_s);
    Time next_cycle = robot_->clock().now();
    while (next_cycle < end) {
      next_cycle += kControlCycle;
      if (auto slept = robot_->clock().sleep_until(next_cycle); !slept) return slept;
      const auto state = KAZ_TRY(robot_->state());
      newest_ = state.angle;
      while (true) {
        auto next = KAZ_TRY(capture_->poll());
        if (!next) break;
        pipeline_->submit(std::move(*next));
      }
      pipeline_->poll(robot_->clock().now());
      if (options_.on_time) options_.on_time(robot_->clock().now(), whole());
      if (failed_) return tl::unexpected(*failed_);
    }
    return {};
  }

  // A picture's floor has come, `delay` late.
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
    look(then.camera, then.foot_from_eye, out_->boxes, out_->edges);
    out_->swept.push_back({then.exposure, robot_->clock().now(), then.joint_rad[host::neck_pan],
                           newest_[host::neck_pan], floor_share(planes), floor_cells(out_->with),
                           floor_cells(out_->without)});
    const double pan = then.joint_rad[host::neck_pan], passed = seconds(then.exposure - before_);
    if (out_->pictures > 1)
      out_->fastest_rad_per_s = std::max(out_->fastest_rad_per_s, std::abs(pan - pan_) / passed);
    if (std::abs(pan) < 0.1) out_->eye = frame.images().left;
    pan_ = pan;
    before_ = then.exposure;
    return std::nullopt;
  }

  const Options& options_;
  std::optional<Sweep> out_;
  std::unique_ptr<sim::Simulation> simulation_;
  std::optional<lockstep::LockstepClock> raw_clock_;
  std::optional<lockstep::LockstepLink> raw_link_;
  std::optional<host::InterruptibleClock> clock_;
  std::optional<host::InterruptibleLink> link_;
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

Result<Sweep> sweep(const Options& options) {
  return Run(options).run();
}

}  // namespace kaz::figure7
