// What the paper's figures need of a run, collected while it goes on.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/figures/run_collector.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "sim/view/camera.h"

namespace kaz::tools {
namespace {

using Eigen::Vector3d;

// Poses of the newest 0.5 s: a result is at most some 0.1 s behind its exposure.
constexpr Time kPoseEvery = std::chrono::milliseconds(5);
constexpr std::size_t kPoses = 100, kSeen = 8;
// Of figure 3: the ball's least radius, px, and how much of the picture must have flow and depth.
constexpr double kMinRadius_px = 4, kMinKnown = 0.3;
// px between frames; what is faster is blurred, and too far away to compare.
constexpr double kFastest_px = 14;
// Of figure 6, in the order of the pictures: left to right.
constexpr double kPans[] = {60 * kDegree, 30 * kDegree, 0, -30 * kDegree, -60 * kDegree};

template <class T, class Known>
double share(const std::vector<T>& all, Known known) {
  return all.empty() ? 0
                     : static_cast<double>(std::ranges::count_if(all, known)) /
                           static_cast<double>(all.size());
}

template <class T>
void subscribe(vision::Pipeline& pipeline, const char* module,
               std::function<void(const vision::Frame&, const T&)> use) {
  // Cannot fail: listen() has the module added.
  static_cast<void>(pipeline.subscribe<T>(
      module, [use = std::move(use)](const vision::Frame& frame, const T* value, const Error*) {
        if (value != nullptr) use(frame, *value);
      }));
}

sim::View view_from(const Vector3d& eye, const Vector3d& target, double horizontal_rad) {
  sim::View view;
  view.camera = sim::Pinhole::from_horizontal_view(960, 720, horizontal_rad);
  view.samples_per_axis = 2;
  view.world_from_optical = sim::look_at(eye, target);
  return view;
}

std::pair<double, double> pixel_of(const sim::View& view, const Vector3d& point) {
  const Vector3d p = view.world_from_optical.inverse() * point;
  return {view.camera.fx * p.x() / p.z() + view.camera.cx,
          view.camera.fy * p.y() / p.z() + view.camera.cy};
}

}  // namespace

void RunCollector::listen(SessionOptions& options) {
  options.onlooker = this;
  options.watcher = this;
  options.listener = this;
  if (wanted_.scene) options.vision.modules = "color,depth,flow";
  if (wanted_.moments)
    options.on_moments = [this](const std::vector<MomentPictures>& moments) { moments_ = moments; };
}

// ---- The simulated world, from outside

RunCollector::Pose RunCollector::pose_of(const sim::Simulation& simulation) const {
  const sim::World& world = simulation.world();
  Pose pose{simulation.time(), world.pose(), world.link_pose("trunk").translation(), {}};
  if (const auto ball = world.object_position("ball")) pose.ball = *ball;
  return pose;
}

void RunCollector::look(sim::Simulation& simulation) {
  simulation_ = &simulation;
  if (wanted_.setup && !setup_) draw_setup(simulation);
  if (!wanted_.scene) return;
  if (!poses_.empty() && simulation.time() < poses_.back().time + kPoseEvery) return;
  poses_.push_back(pose_of(simulation));
  if (poses_.size() > kPoses) poses_.pop_front();
}

vision::Image RunCollector::drawn(sim::Simulation& simulation, const sim::View& view,
                                  const sim::ScenePose& pose) {
  auto picture = simulation.picture(view, pose);
  if (picture) return {picture->width, picture->height, std::move(picture->rgb)};
  error_ = picture.error();
  return {};
}

// From the robot's right, and from above with the robot's forward up.
void RunCollector::draw_setup(sim::Simulation& simulation) {
  constexpr double kSideView = 0.7, kView = 0.8;  // rad
  const Pose now = pose_of(simulation);
  const Vector3d forward = simulation.world().link_pose("trunk").linear().col(0);
  const double heading = std::atan2(forward.y(), forward.x());
  const Eigen::AngleAxisd turned(heading, Vector3d::UnitZ());
  const Vector3d start(now.trunk.x(), now.trunk.y(), 0);
  const Vector3d end = now.ball.value_or(start + turned * Vector3d::UnitX());
  const Vector3d middle = 0.5 * (start + end);
  const double extent = (end - start).norm();
  SetupView setup;
  const Vector3d aside = turned * Vector3d(-0.35, -1, 0.75).normalized(),
                 behind = turned * Vector3d(-0.02, 0, 1);
  const sim::View side = view_from(middle + (1.0 + 1.3 * extent) * aside, middle, kSideView);
  const sim::View above = view_from(middle + (1.1 + 1.3 * extent) * behind, middle, kView);
  setup.from_side = drawn(simulation, side, now.scene);
  setup.from_above = drawn(simulation, above, now.scene);
  setup.robot_px = pixel_of(above, start);
  if (now.ball) {
    setup.ball_px = pixel_of(above, *now.ball);
    setup.ball_m = (turned.inverse() * (*now.ball - start)).head<2>();
  }
  setup_ = std::move(setup);
}

// ---- What vision finds

void RunCollector::begin(vision::Pipeline& pipeline) {
  if (wanted_.scene) {
    subscribe<vision::BallObservation>(
        pipeline, "color", [this](const vision::Frame& frame, const vision::BallObservation& ball) {
          seen(frame.info().sequence).ball = ball;
        });
    subscribe<vision::FlowImage>(pipeline, "flow",
                                 [this](const vision::Frame& frame, const vision::FlowImage& flow) {
                                   if (flow.width > 0) seen(frame.info().sequence).flow = flow;
                                 });
    subscribe<vision::DepthImage>(
        pipeline, "depth", [this](const vision::Frame& frame, const vision::DepthImage& depth) {
          consider(frame, depth);
        });
  }
  if (wanted_.plan) {
    subscribe<vision::PlaneSegments>(
        pipeline, "floor", [this](const vision::Frame& frame, const vision::PlaneSegments& planes) {
          consider(frame, planes);
        });
  }
}

RunCollector::Seen& RunCollector::seen(std::uint64_t sequence) {
  const auto at = std::ranges::find(seen_, sequence, &Seen::sequence);
  if (at != seen_.end()) return *at;
  if (seen_.size() == kSeen) seen_.pop_front();
  return seen_.emplace_back(Seen{sequence, {}, {}});
}

// The frame with the ball's largest displacement, those downwards first: the paper's ball is falling.
void RunCollector::consider(const vision::Frame& frame, const vision::DepthImage& depth) {
  Seen& now = seen(frame.info().sequence);
  if (!now.ball) return;
  const auto before = std::exchange(ball_before_, now.ball);
  const vision::BallObservation& ball = *now.ball;
  if (!before || !before->found || !ball.found || frame.after_gap() || !now.flow ||
      ball.radius_px < kMinRadius_px)
    return;
  const double right = ball.center_u - before->center_u, down = ball.center_v - before->center_v;
  const double moved = std::hypot(right, down);
  const double score = moved + std::max(0.0, down);
  if (moved > kFastest_px || score <= scene_score_) return;
  const double known_depth = share(depth.disparity_px, [](float d) { return d > 0; });
  const double known_flow =
      share(now.flow->flow_px, [](const Eigen::Vector2f& f) { return !std::isnan(f.x()); });
  if (known_depth < kMinKnown || known_flow < kMinKnown || poses_.empty()) return;
  scene_score_ = score;
  scene_.emplace(SceneView{frame.shared_images(), ball, depth, *now.flow, moved});
  scene_pose_ = *std::ranges::min_element(poses_, {}, [&](const Pose& pose) {
    return std::abs((pose.time - frame.info().exposure).count());
  });
}

// Of each direction the frame that is nearest to it.
void RunCollector::consider(const vision::Frame& frame, const vision::PlaneSegments& planes) {
  const vision::FrameInfo& info = frame.info();
  if (!looks_around_ || plan_ || !info.posture_known) return;
  const double pan = info.joint_rad[host::neck_pan];
  const double wanted = *std::ranges::min_element(
      kPans, {}, [&](double direction) { return std::abs(direction - pan); });
  const auto at = std::ranges::find(look_around_, wanted, &PlaneView::wanted_pan_rad);
  if (at != look_around_.end() && std::abs(at->pan_rad - wanted) <= std::abs(pan - wanted)) return;
  PlaneView view{wanted, pan, frame.shared_images(), planes, frame.of<vision::DepthImage>("depth")};
  if (at != look_around_.end()) {
    *at = std::move(view);
  } else {
    look_around_.push_back(std::move(view));
    std::ranges::sort(look_around_, std::greater(), &PlaneView::wanted_pan_rad);
  }
}

// The simulation is still there.
void RunCollector::end(const vision::Pipeline& /*pipeline*/) {
  if (simulation_ == nullptr || !scene_ || !scene_pose_) return;
  std::optional<Vector3d> middle;
  double extent = 0;
  if (scene_pose_->ball) {
    middle = 0.5 * (scene_pose_->trunk + *scene_pose_->ball);
    extent = (scene_pose_->trunk - *scene_pose_->ball).norm();
  }
  // Large, so that the eyes' pictures in it take little of it.
  constexpr int kWidth_px = 1280;
  scene_->outside =
      drawn(*simulation_, onlooker_view(middle, extent, kWidth_px), scene_pose_->scene);
  simulation_ = nullptr;
}

// ---- What the behavior reports

void RunCollector::phase(Time /*time*/, std::string_view /*behavior*/, std::string_view phase) {
  looks_around_ = phase == "look around";
  // Again, perhaps from elsewhere, where it had to search for the ball.
  if (looks_around_ && !plan_) look_around_.clear();
}

// The first with a path.
void RunCollector::map(const behavior::MapReport& report) {
  if (!wanted_.plan || plan_ || report.path.size() < 2) return;
  plan_.emplace(PlanView{report.time, report.map, report.robot, report.goal, report.heading_rad,
                         report.path});
}

}  // namespace kaz::tools
