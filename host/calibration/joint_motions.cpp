// The presses against stops and the postures on the floor.
// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/joint_motions.h"

#include <algorithm>

#include "shared/base/angle.hpp"

namespace kaz::calibration {

namespace {

using namespace host;

struct Arm {
  double shoulder = 0, spread = 0, elbow = 0;
};
struct Leg {
  double spread = 0, hip = 0, knee = 0, ankle = 0;
};
struct Body {
  Arm left_arm, right_arm;
  Leg left_leg, right_leg;
};

JointAngles angles_of(const Body& body) {
  JointAngles a{};
  a[l_sh_pitch] = body.left_arm.shoulder;
  a[l_sh_roll] = body.left_arm.spread;
  a[l_elbow] = body.left_arm.elbow;
  a[r_sh_pitch] = body.right_arm.shoulder;
  a[r_sh_roll] = -body.right_arm.spread;
  a[r_elbow] = body.right_arm.elbow;
  a[l_hip_roll] = body.left_leg.spread;
  a[l_hip_pitch] = body.left_leg.hip;
  a[l_knee] = body.left_leg.knee;
  a[l_ankle_pitch] = body.left_leg.ankle;
  a[r_hip_roll] = -body.right_leg.spread;
  a[r_hip_pitch] = body.right_leg.hip;
  a[r_knee] = body.right_leg.knee;
  a[r_ankle_pitch] = body.right_leg.ankle;
  for (double& angle : a) angle *= kDegree;
  return a;
}

constexpr Arm kAside{0, 30, 0}, kFarAside{0, 80, 0};

StopStep way(const Body& body) {
  return {angles_of(body), {}};
}
StopStep press(const Body& body, std::vector<Press> presses) {
  return {angles_of(body), std::move(presses)};
}
Body arms(const Arm& left, const Arm& right) {
  return {left, right, {}, {}};
}
Body legs(const Leg& left, const Leg& right) {
  return {{0, 60, 0}, {0, 60, 0}, left, right};
}

using enum Stop;

std::vector<MotionGroup> make_groups() {
  const Body rest = arms(kAside, kAside);
  // An arm crosses the chest in front of it, straight ahead, while the other is out of its way.
  const Arm ahead{-90, 0, 0}, ahead_aside{-90, 80, 0};
  // A leg crosses below the other, which is lifted forward.
  const Leg down{}, lifted{0, -100, 0, 0};
  return {
      {"head and hands",
       "the head turns and nods to both stops; the hands open and close",
       {press(rest, {{neck_pan, lower}, {neck_tilt, lower}, {l_hand, lower}, {r_hand, lower}}),
        press(rest, {{neck_pan, upper}, {neck_tilt, upper}, {l_hand, upper}, {r_hand, upper}})}},
      {"arms",
       "both arms swing to their stops: backward, overhead and outward; the elbows bend and "
       "stretch; then each arm swings across the chest",
       {way(rest),
        press(arms({20, 30, 0}, {20, 30, 0}),
              {{l_elbow, upper}, {r_elbow, upper}, {l_sh_pitch, upper}, {r_sh_pitch, upper}}),
        press(arms({0, 30, -120}, {0, 30, -120}), {{l_elbow, lower}, {r_elbow, lower}}),
        press(arms({-120, 30, -20}, {-120, 30, -20}), {{l_sh_pitch, lower}, {r_sh_pitch, lower}}),
        press(arms({0, 90, 0}, {0, 90, 0}), {{l_sh_roll, upper}, {r_sh_roll, lower}}),
        way(arms(ahead_aside, ahead_aside)),
        press(arms({-90, -30, 0}, ahead_aside), {{l_sh_roll, lower}}),
        way(arms(ahead_aside, ahead_aside)),
        press(arms(ahead_aside, {-90, -30, 0}), {{r_sh_roll, upper}}),
        way(arms(ahead, ahead_aside)), way(arms(kFarAside, kFarAside)), way(rest)}},
      {"legs",
       "both legs swing to their stops: backward, up to the chest, and outward; feet and knees "
       "move to both stops; then each leg swings inward past the other leg",
       {way(legs(down, down)),
        press(legs({0, 0, 5, -65}, {0, 0, 5, -65}),
              {{l_ankle_pitch, lower}, {r_ankle_pitch, lower}, {l_knee, lower}, {r_knee, lower}}),
        press(legs({0, 25, 20, 45}, {0, 25, 20, 45}), {{l_ankle_pitch, upper},
                                                       {r_ankle_pitch, upper},
                                                       {l_hip_pitch, upper},
                                                       {r_hip_pitch, upper}}),
        press(legs({0, -100, 125, -60}, {0, -100, 125, -60}), {{l_knee, upper}, {r_knee, upper}}),
        press(legs({0, -125, 90, 0}, {0, -125, 90, 0}),
              {{l_hip_pitch, lower}, {r_hip_pitch, lower}}),
        way(legs({0, -60, 60, 0}, {0, -60, 60, 0})), way(legs(down, down)),
        press(legs({30, 0, 0, 0}, {30, 0, 0, 0}), {{l_hip_roll, upper}, {r_hip_roll, lower}}),
        way(legs(down, lifted)), press(legs({-30, 0, 0, 0}, lifted), {{l_hip_roll, lower}}),
        way(legs(down, lifted)), way(legs(down, down)), way(legs(lifted, down)),
        press(legs(lifted, {-30, 0, 0, 0}), {{r_hip_roll, upper}}), way(legs(lifted, down)),
        way(legs(down, down)), way(rest)}}};
}

// Hips' distance ahead of the ankles at which the centre of mass is above the middle of the soles.
motion::Stance balanced(double height_m, double pitch_deg, double roll_deg) {
  constexpr double kMiddle = (motion::kToe + motion::kHeel) / 2;
  motion::Stance stance{0, height_m, pitch_deg * kDegree, roll_deg * kDegree};
  for (int i = 0; i < 20; ++i) stance.x += kMiddle - motion::centre_over_feet(stance).x();
  return stance;
}

}  // namespace

std::span<const MotionGroup> stop_groups() {
  static const std::vector<MotionGroup> groups = make_groups();
  return groups;
}

std::span<const motion::Stance> floor_stances() {
  static const std::vector<motion::Stance> stances = [] {
    std::vector<motion::Stance> all;
    for (const double pitch : {3, 15, -6})
      for (const double height : {0.150, 0.138, 0.122, 0.105})
        all.push_back(balanced(height, pitch, 0));
    for (const double roll : {4, 7, -4, -7}) all.push_back(balanced(0.140, 3, roll));
    all.push_back(balanced(0.145, 3, 0));
    return all;
  }();
  return stances;
}

host::JointAngles posture_of(const motion::Stance& stance) {
  host::JointAngles angles = motion::home();
  motion::place_legs(angles, stance, {});
  return angles;
}

}  // namespace kaz::calibration
