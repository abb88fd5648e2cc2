// One exchange per control cycle for all joints.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/body_control.h"

#include <algorithm>
#include <cmath>

#include "host/behavior/walker.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr double kHeadSpeed = 2.5;  // rad/s, maximum speed of the head
constexpr double kMargin = 0.017;   // rad, inside the joints' limits
// Fall detection during poses uses the lateral component of gravity (g, low-pass filtered) only: the
// forward component changes when the robot bends down.
constexpr double kTipped = 0.7, kGravity = 9.81, kTippedFor_s = 0.3, kSmoothing_s = 0.15;
// With the head far down and turned to the side, the chest occludes the floor before the feet. The
// field of view extends 32 degrees below the optical axis, so for targets there the tilt is limited and
// the pan reduced towards straight ahead.
constexpr double kDown = 40 * kDegree, kMaxDown = 52 * kDegree;
constexpr double kMinPan = 0.3;  // share of the ball's pan at kMaxDown

host::Gaze limit_over_chest(host::Gaze gaze) {
  const double share = std::clamp((gaze.tilt_rad - kDown) / (kMaxDown - kDown), 0.0, 1.0);
  gaze.pan_rad *= std::lerp(1.0, kMinPan, share);
  gaze.tilt_rad = std::min(gaze.tilt_rad, kMaxDown);
  return gaze;
}

constexpr Time kZero = std::chrono::milliseconds(2600);  // 2 s of it average the gyro's offset

}  // namespace

BodyControl::BodyControl(Context& context, std::string_view behavior, const motion::Motion& motion)
    : context_(&context),
      behavior_(behavior),
      motion_(motion),
      cycle_(context),
      ball_(context.ball_radius_m) {}

Result<BodyControl> BodyControl::begin(Context& context, std::string_view behavior) {
  if (!context.vision)
    return fail(Fault::usage, std::string(behavior) + " needs a camera: give one with --camera");
  auto walker = KAZ_TRY(Walker::begin(context, behavior));
  BodyControl body(context, behavior, walker.motion());
  body.input_ = walker.input();
  body.gaze_ = host::gaze_of(body.measured());
  body.newest_exposure_ = body.now();
  return body;
}

host::Gaze BodyControl::head() {
  if (tracks_ball_ && ball_.known()) {
    const Eigen::Vector2d at = ball_now();
    const host::Side foot = host::supporting_foot(measured());
    const Eigen::Vector3d hips = motion::hips_over_sole(measured(), foot);
    const Eigen::Vector3d from_sole(hips.x() + at.x(), hips.y() + at.y(), context_->ball_radius_m);
    const host::Gaze ball =
        limit_over_chest(host::gaze_at(host::trunk_from_sole(measured(), foot) * from_sole));
    const double max_step = kHeadSpeed * seconds(cycle_.duration());  // rad
    gaze_.pan_rad += std::clamp(ball.pan_rad - gaze_.pan_rad, -max_step, max_step);
    gaze_.tilt_rad += std::clamp(ball.tilt_rad - gaze_.tilt_rad, -max_step, max_step);
  }
  return gaze_ = host::within_limits(gaze_, kMargin);
}

Result<void> BodyControl::step() {
  KAZ_TRY(step_once());
  if (!camera_lost() || fallen()) return {};
  phase("wait for the camera");
  motion_.stop();
  while (camera_lost() && !fallen()) KAZ_TRY(step_once());
  return {};
}

Result<void> BodyControl::step_once() {
  const auto legs = motion_.step(now(), input_.posture);
  if (fallen()) {
    phase("fallen");
    return context_->robot.enable(0);
  }
  places_.add(input_.posture.time, motion_.place());
  return run_cycle({legs.begin(), legs.end()});
}

Result<void> BodyControl::step(const host::JointAngles& pose) {
  detect_fall();
  if (fallen()) {
    phase("fallen");
    return context_->robot.enable(0);
  }
  std::vector<host::JointTarget> targets;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (j != host::neck_pan && j != host::neck_tilt)
      targets.push_back({j, pose[static_cast<std::size_t>(j)]});
  }
  return run_cycle(std::move(targets));
}

Result<void> BodyControl::run_cycle(std::vector<host::JointTarget> targets) {
  const host::Gaze to = head();
  CycleRow row;
  row.time = now();
  row.pan_target = to.pan_rad;
  row.tilt_target = to.tilt_rad;
  const host::Gaze measured_gaze = host::gaze_of(measured());
  row.pan_measured = measured_gaze.pan_rad;
  row.tilt_measured = measured_gaze.tilt_rad;
  context_->sink.cycle(row);

  targets.push_back({host::neck_pan, to.pan_rad});
  targets.push_back({host::neck_tilt, to.tilt_rad});
  KAZ_TRY(cycle_.advance(targets, input_));
  process_observations();
  return {};
}

void BodyControl::process_observations() {
  for (const vision::BallObservation& observation : input_.observations) {
    newest_exposure_ = observation.info.exposure;
    const bool used = ball_.observe(observation, places_);
    consecutive_ = used ? consecutive_ + 1 : 0;
    if (used) newest_ball_ = observation;
    context_->sink.picture(picture_row(observation));
  }
}

void BodyControl::detect_fall() {
  if (!input_.posture.inertial) return;
  const double dt = seconds(cycle_.duration()), share = dt / (kSmoothing_s + dt);
  left_g_ += share * (input_.posture.inertial->left_m_per_s2 / kGravity - left_g_);
  tipped_s_ = std::abs(left_g_) > kTipped ? tipped_s_ + dt : 0;
  fallen_ = fallen_ || tipped_s_ > kTippedFor_s;
}

Result<void> BodyControl::stay(Time duration) {
  const Time end = now() + duration;
  while (now() < end && !fallen())
    if (auto done = step(); !done) return done;
  return {};
}

Result<void> BodyControl::finish(Time after) {
  while (!motion_.idle() && !fallen())
    if (auto done = step(); !done) return done;
  return stay(after);
}

Result<void> BodyControl::restart() {
  motion_ = motion::Motion();
  ball_.forget();
  places_.clear();
  left_g_ = tipped_s_ = 0;
  return stay(kZero);
}

}  // namespace kaz::behavior
