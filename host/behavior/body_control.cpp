// One exchange a beat for all that moves.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/body_control.h"

#include <algorithm>
#include <cmath>

#include "host/behavior/walker.h"

namespace kaz::behavior {

namespace {

// Ramps are a little longer than beats, so that the motion has no steps.
constexpr double kBeyond = 1.15;
constexpr Time kShortest = std::chrono::milliseconds(12), kLongest = std::chrono::milliseconds(40);
constexpr double kHeadSpeed = 2.5;  // rad/s, most that the head is turned
constexpr double kMargin = 0.017;   // rad, inside the joints' limits
// Bent forward, gravity along the trunk says little; to the side it says when the robot lies.
constexpr double kTipped = 0.7, kGravity = 9.81, kTippedFor_s = 0.3, kSmoothing_s = 0.15;
// Turned far down, and aside besides, the eyes come so low over the chest that it hides what lies
// before the feet. They see 32 degrees below their axis: what lies there is looked at from less far
// down, nearly straight ahead.
constexpr double kDown = 40 * motion::kDegree, kFarthestDown = 52 * motion::kDegree;
constexpr double kLeastPan = 0.3;  // of the ball's

host::Gaze past_the_chest(host::Gaze gaze) {
  const double share = std::clamp((gaze.tilt_rad - kDown) / (kFarthestDown - kDown), 0.0, 1.0);
  gaze.pan_rad *= std::lerp(1.0, kLeastPan, share);
  gaze.tilt_rad = std::min(gaze.tilt_rad, kFarthestDown);
  return gaze;
}

constexpr Time kZero = std::chrono::milliseconds(2600);  // 2 s of them for the gyro's zero

}  // namespace

BodyControl::BodyControl(Context& context, std::string_view behavior, const motion::Motion& motion)
    : context_(&context),
      behavior_(behavior),
      motion_(motion),
      cycle_(context),
      ball_(context.ball_radius_m) {}

Result<BodyControl> BodyControl::begin(Context& context, std::string_view behavior) {
  if (!context.sight)
    return fail(Fault::usage, std::string(behavior) + " needs a camera: give one with --camera");
  auto walker = Walker::begin(context, behavior);
  if (!walker) return tl::unexpected(walker.error());
  BodyControl body(context, behavior, walker->motion());
  body.input_ = walker->input();
  body.gaze_ = host::gaze_of(body.measured());
  body.newest_exposure_ = body.now();
  return body;
}

host::Gaze BodyControl::head() {
  if (follows_ && ball_.known()) {
    const Eigen::Vector2d at = ball_now();
    const host::Side foot = host::supporting_foot(measured());
    const Eigen::Vector3d hips = motion::hips_over_sole(measured(), foot);
    const Eigen::Vector3d from_sole(hips.x() + at.x(), hips.y() + at.y(), context_->ball_radius_m);
    const host::Gaze ball =
        past_the_chest(host::gaze_at(host::trunk_from_sole(measured(), foot) * from_sole));
    const double most = kHeadSpeed * seconds(beat_);
    gaze_.pan_rad += std::clamp(ball.pan_rad - gaze_.pan_rad, -most, most);
    gaze_.tilt_rad += std::clamp(ball.tilt_rad - gaze_.tilt_rad, -most, most);
  }
  return gaze_ = host::within_limits(gaze_, kMargin);
}

Result<void> BodyControl::step() {
  const auto legs = motion_.step(now(), input_.posture);
  if (fallen()) {
    phase("fallen");
    return context_->robot.enable(0);
  }
  ball_.at_place(input_.posture.time, motion_.place());
  return beat({legs.begin(), legs.end()});
}

Result<void> BodyControl::step(const host::JointAngles& pose) {
  watch_for_a_fall();
  if (fallen()) {
    phase("fallen");
    return context_->robot.enable(0);
  }
  std::vector<host::JointTarget> targets;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (j != host::neck_pan && j != host::neck_tilt)
      targets.push_back({j, pose[static_cast<std::size_t>(j)]});
  }
  return beat(std::move(targets));
}

Result<void> BodyControl::beat(std::vector<host::JointTarget> targets) {
  const host::Gaze to = head();
  CycleRow row;
  row.time = now();
  row.pan_target = to.pan_rad;
  row.tilt_target = to.tilt_rad;
  const host::Gaze measured_gaze = host::gaze_of(measured());
  row.pan_measured = measured_gaze.pan_rad;
  row.tilt_measured = measured_gaze.tilt_rad;
  row.ball_known = follows_ && ball_.known();
  row.ball_pan = to.pan_rad;
  row.ball_tilt = to.tilt_rad;
  context_->sink.cycle(row);

  targets.push_back({host::neck_pan, to.pan_rad});
  targets.push_back({host::neck_tilt, to.tilt_rad});
  const Time before = now();
  const Time ramp = std::clamp(from_seconds(kBeyond * seconds(beat_)), kShortest, kLongest);
  auto input = cycle_.next(targets, ramp);
  if (!input) return tl::unexpected(input.error());
  input_ = std::move(*input);
  beat_ = now() - before;
  take_in();
  return {};
}

void BodyControl::take_in() {
  for (const vision::BallObservation& observation : input_.seen) {
    PictureRow row;
    row.exposure = observation.info.exposure;
    row.known_at = now();
    row.found = observation.found;
    if (observation.found) {
      row.error_rad = std::acos(std::clamp(observation.direction.z(), -1.0, 1.0));
      row.distance_m = observation.distance_m;
    }
    newest_exposure_ = observation.info.exposure;
    const bool used = ball_.observe(observation);
    seen_in_a_row_ = used ? seen_in_a_row_ + 1 : 0;
    context_->sink.picture(row);
  }
}

void BodyControl::watch_for_a_fall() {
  if (!input_.posture.inertial) return;
  const double dt = seconds(beat_), share = dt / (kSmoothing_s + dt);
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
  ball_.restart();
  left_g_ = tipped_s_ = 0;
  return stay(kZero);
}

}  // namespace kaz::behavior
