// get-up: from any fallen posture to the walking crouch, by a sequence of poses with linear joint ramps.
// SPDX-License-Identifier: Apache-2.0
//
// From the face: the legs are drawn under the belly, the arms spread overhead and swept in below the
// shoulders, which lifts the chest; then the weight is on the soles, and trunk and knees are extended.
// From the back: the right arm behind the back rolls the robot on its left side, both legs forward carry
// it over; the spread left arm lifts it to sitting; with arms behind and knees drawn up, the arms swing
// forward and tip it over its feet onto its hands; from there as from the face.
// The poses were found in simulation (docs/explanation/motion.md).
#include "host/behavior/get_up.h"

#include <algorithm>
#include <cmath>

#include "host/behavior/control_cycle.h"
#include "host/motion/gait.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

using host::JointAngles;

constexpr Option kOptions[] = {{"attempts", "3", "", 1, 10, "maximum number of attempts", true}};

constexpr double kLying_g = 0.6;  // sin 37 degrees; the sensor's offset may be 0.2 g
constexpr double kGravity = 9.81;
constexpr double kSettle_s = 0.2, kObserve_s = 0.4;
constexpr double kRamp = 12;            // rad/s, as when walking
constexpr double kNear = 20 * kDegree;  // of the crouch
constexpr double kStandUp_s = 1.5, kStood_s = 1.0;
constexpr double kStays_s = 2.0;  // after it was found upright, before it is believed to stay so

// Joint angles in degrees. Shoulder roll (spread): outward.
struct Limbs {
  double hip, knee, ankle, shoulder, spread, elbow;
};
struct Pose {
  double seconds;
  Limbs left, right;
  double neck_tilt = 0;
};
constexpr Pose both(double seconds, const Limbs& limbs, double neck_tilt = 0) {
  return {seconds, limbs, limbs, neck_tilt};
}

constexpr Pose kOnFace[] = {
    both(0.6, {0, 30, -78, 0, 95, 0}, -40),
    both(0.8, {0, 30, -78, -110, 95, 0}, -40),
    both(2.0, {-135, 136, -78, -110, 95, 0}, -40),
};
constexpr Pose kOnHands[] = {
    both(1.5, {-135, 136, -78, -110, 10, 0}, -40),
    both(1.0, {-110, 136, -78, -90, 10, 0}),
    both(1.0, {-90, 125, -65, -60, 10, -20}),
};
constexpr Pose kRollLeft[] = {
    {0.8, {0, 0, 0, -30, -40, -60}, {-60, 0, 0, 20, 30, 5}},
    {0.4, {0, 0, 0, -30, -40, -60}, {-60, 0, 0, 39, 0, 9}},
    {0.5, {0, 0, 0, -60, -40, -60}, {-90, 0, 0, 39, -30, 9}},
};
constexpr Pose kOnLeftSide[] = {
    {0.6, {-110, 20, 0, -90, -40, -30}, {-110, 20, 0, 39, -30, 9}},
    {0.8, {-110, 20, 0, -90, 60, 0}, {-110, 20, 0, 39, 60, 9}},
};
constexpr Pose kSits[] = {
    both(0.6, {-110, 20, 0, 30, 40, 0}),        both(1.0, {-139, 138, 0, 30, 40, 0}),
    both(0.4, {-139, 138, -20, 39, 15, 9}),     both(0.6, {-139, 138, -50, 0, 15, 0}),
    both(0.6, {-135, 136, -78, 0, 95, 0}, -40), both(0.8, {-135, 136, -78, -110, 95, 0}, -40),
};

JointAngles angles_of(const Pose& pose, bool mirrored) {
  JointAngles angles{};
  const auto place = [&angles](const Limbs& limbs, bool left) {
    const auto at = [&angles, left](int l, int r) -> double& {
      return angles[static_cast<std::size_t>(left ? l : r)];
    };
    at(host::l_hip_pitch, host::r_hip_pitch) = limbs.hip * kDegree;
    at(host::l_knee, host::r_knee) = limbs.knee * kDegree;
    at(host::l_ankle_pitch, host::r_ankle_pitch) = limbs.ankle * kDegree;
    at(host::l_sh_pitch, host::r_sh_pitch) = limbs.shoulder * kDegree;
    at(host::l_sh_roll, host::r_sh_roll) = (left ? limbs.spread : -limbs.spread) * kDegree;
    at(host::l_elbow, host::r_elbow) = limbs.elbow * kDegree;
  };
  place(mirrored ? pose.right : pose.left, true);
  place(mirrored ? pose.left : pose.right, false);
  angles[host::neck_tilt] = pose.neck_tilt * kDegree;
  return angles;
}

class GettingUp {
 public:
  explicit GettingUp(Context& context) : context_(context), cycle_(context) {}

  // Classifies the mean specific force over kObserve_s while the robot lies still.
  Result<Lying> observe() {
    double forward = 0, left = 0;
    int samples = 0;
    for (const Time end = context_.clock.now() + from_seconds(kObserve_s);
         context_.clock.now() < end;) {
      const auto input = cycle_.next({});
      if (!input) return tl::unexpected(input.error());
      if (!input->posture.inertial) continue;
      forward += input->posture.inertial->forward_m_per_s2 / kGravity;
      left += input->posture.inertial->left_m_per_s2 / kGravity;
      ++samples;
      angles_ = input->posture.angle;
    }
    if (samples == 0)
      return fail(Fault::environment,
                  "get-up: the board sends no accelerometer data; check the sensor's connection");
    return lying_from(forward / samples, left / samples);
  }

  Result<void> go(const JointAngles& goal, double time_s, double then_s) {
    std::vector<host::JointTarget> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) targets.push_back({j, goal[static_cast<std::size_t>(j)]});
    bool begin = true;
    Time end{};
    while (begin || context_.clock.now() < end) {
      if (begin) end = context_.clock.now() + from_seconds(time_s + then_s);
      const auto input =
          cycle_.next(begin ? targets : std::vector<host::JointTarget>{}, from_seconds(time_s));
      if (!input) return tl::unexpected(input.error());
      begin = input->resumed.has_value();  // a lost link ends all ramps
    }
    return {};
  }

  // Upright, and so it is after kStays_s. `upright_at`: when it was found so.
  Result<Lying> watch(Time& upright_at) {
    const auto first = KAZ_TRY(observe());
    upright_at = context_.clock.now();
    if (first != Lying::upright) return first;
    for (const Time end = upright_at + from_seconds(kStays_s); context_.clock.now() < end;)
      KAZ_TRY(cycle_.next({}));
    return observe();
  }

  Result<void> go(std::span<const Pose> poses, bool mirrored = false) {
    for (const Pose& pose : poses)
      if (auto gone = go(angles_of(pose, mirrored), pose.seconds, kSettle_s); !gone) return gone;
    return {};
  }

  // Runs the poses from `lies` to standing. Upright with other leg angles than the crouch's, it sits.
  Result<void> rise(Lying lies) {
    const bool mirrored = lies == Lying::on_right;
    std::vector<std::span<const Pose>> parts;
    const bool sits = lies == Lying::upright && !crouches();
    if (sits) parts.emplace_back(kSits);
    if (lies == Lying::on_back) parts.emplace_back(kRollLeft);
    if (lies == Lying::on_back || lies == Lying::on_left || lies == Lying::on_right) {
      parts.emplace_back(kOnLeftSide);
      parts.emplace_back(kSits);
    }
    if (lies == Lying::on_face) parts.emplace_back(kOnFace);
    if (lies != Lying::upright || sits) parts.emplace_back(kOnHands);
    for (const auto& part : parts)
      if (auto gone = go(part, mirrored); !gone) return gone;
    return go(motion::home(), kStandUp_s, kStood_s);
  }

 private:
  bool crouches() const {
    const JointAngles home = motion::home();
    for (const int joint : {host::l_hip_pitch, host::l_knee, host::l_ankle_pitch, host::r_hip_pitch,
                            host::r_knee, host::r_ankle_pitch}) {
      const auto j = static_cast<std::size_t>(joint);
      if (std::abs(angles_[j] - home[j]) > kNear) return false;
    }
    return true;
  }

  Context& context_;
  ControlCycle cycle_;
  JointAngles angles_{};  // at the last observe()
};

const char* name_of(Lying lies) {
  constexpr const char* kNames[] = {"on its face", "on its back", "on its left side",
                                    "on its right side", "upright"};
  return kNames[static_cast<int>(lies)];
}

Result<Outcome> run(Context& context) {
  if (!context.other_joints.empty())
    return fail(Fault::usage, "get-up needs Kaz's arms and legs, and this robot has none");
  const auto inertial = KAZ_TRY(context.robot.sense_inertial());
  if (!inertial)
    return fail(Fault::usage,
                "get-up needs an accelerometer, but the board has no accelerometer: add one, or "
                "give --imu for the virtual robot");
  if (auto set = context.robot.set_limits(host::kAllJoints, {.ramp_rad_per_s = kRamp}); !set)
    return tl::unexpected(set.error());
  GettingUp getting_up(context);
  const Time began = context.clock.now();
  Time upright_at = began;
  const int max_attempts = static_cast<int>(context.options.number("attempts"));
  int attempts = 0;
  Lying first = Lying::upright, lies = Lying::upright;
  for (bool stands = false; !stands && attempts < max_attempts; ++attempts) {
    // Also enables motors that the board disabled after a stall.
    KAZ_TRY(hold_still(context.robot));
    const auto before = KAZ_TRY(getting_up.observe());
    lies = before;
    if (attempts == 0) first = lies;
    context.sink.phase(context.clock.now(), kGetUp.name, name_of(lies));
    KAZ_TRY(getting_up.rise(lies));
    const auto after = KAZ_TRY(getting_up.watch(upright_at));
    lies = after;
    stands = lies == Lying::upright;
  }

  Outcome outcome;
  outcome.success = lies == Lying::upright;
  char text[160];
  std::snprintf(text, sizeof text, "the robot %s after %d attempt%s; at the start the robot was %s",
                outcome.success ? "stands" : "did not get up", attempts, attempts == 1 ? "" : "s",
                name_of(first));
  outcome.sentence = text;
  if (!outcome.success) outcome.cause = "did not get up";
  outcome.measurements = {{"attempts", attempts}, {"getting_up_s", seconds(upright_at - began)}};
  return outcome;
}

}  // namespace

Lying lying_from(double forward_g, double left_g) {
  if (std::hypot(forward_g, left_g) < kLying_g) return Lying::upright;
  if (std::abs(forward_g) >= std::abs(left_g))
    return forward_g < 0 ? Lying::on_face : Lying::on_back;
  return left_g < 0 ? Lying::on_left : Lying::on_right;
}

constinit const Behavior kGetUp{
    .name = "get-up",
    .text = "get up after a fall and stand in the walking crouch",
    .options = kOptions,
    .run = run,
    .evaluation = {.criterion = Criterion::upright, .stage = Stage::lying, .walks = false}};

}  // namespace kaz::behavior
