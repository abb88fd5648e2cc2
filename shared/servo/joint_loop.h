// Controls the joints for one tick: measurement, ramps, position loop, soft limits.
// SPDX-License-Identifier: Apache-2.0
//
//   drive = kp e - kd rate + friction sign(e),  e = command - angle, 0 inside the dead band
//
// The distance from a joint to a soft limit bounds the speed at which the joint may approach the limit:
//
//   max speed = (distance + min(distance, 0.1 rad)) / T,  T = 64 ms
//
// If the speed of a joint is above this maximum, the board brakes the joint with up to full drive. At a limit
// and beyond it, outward drive is set to 0.
//
// With T = 64 ms, full reverse drive at 10 V can stop any joint of Kaz in time. While a joint approaches a
// limit at the maximum speed, the joint's deceleration must be speed / T. Within 0.1 rad of the limit, the
// joint's deceleration must be 2 * speed / T. The hips carry the largest inertia, 0.02 kg m2 (leg stretched).
// To brake from 12 rad/s, a hip needs 3.8 Nm; reverse drive and back-EMF give 4.4 Nm.
//
// To save time, the full computation runs only for `constrained` joints. A joint is constrained if it has a
// dead band or friction, or is near a limit. Every 4 ms, protection.c checks whether a joint is near a limit.
// A joint counts as near a limit if the joint may need to brake for this limit within 4 ms. Joints faster
// than 8 rad/s always count as near a limit.
#ifndef KAZ_SHARED_SERVO_JOINT_LOOP_H
#define KAZ_SHARED_SERVO_JOINT_LOOP_H

#include "shared/servo/joint_drive.h"
#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Maximum change of an angle per tick, in units of 100 urad; larger changes are clamped. The maximum is 51
// rad/s, four times the motor's no-load speed. With this maximum, the filtered rate is at most
// 64 * 511 = 32704, which fits into 16 bits.
#define KZ_DELTA_MAX 511
// Flags of kz_joint.constrained: why the joint needs the full computation.
#define KZ_CONSTRAINED_NEAR_LIMIT 1
#define KZ_CONSTRAINED_BY_FRICTION 2  // has a dead band or friction

// A joint is far from a limit if distance > rate + KZ_FAR_FROM_LIMIT (units: joint_drive.h). Such a joint
// does not have to brake for the limit within 4 ms. If the distance to a limit is more than 0.1 rad, the
// maximum rate toward this limit is: distance + 1000. In 4 ms, the distance shrinks by at most 620, even at
// the no-load speed of 15.5 rad/s at 12 V. In the same time, full drive raises the filtered rate by at most
// 3,420. The reason is that the filter passes 41 % of a speed step in 4 ms. KZ_FAR_FROM_LIMIT must therefore
// be at least 620 + 3420 - 1000 = 3040.
#define KZ_FAR_FROM_LIMIT 3100

// Runs one tick for KZ_JOINTS joints. Computes the angle and rate of each joint from the A/D codes. If a
// joint is on, also updates its ramp, duty and direction. Joints that are off, and joints with a
// potentiometer out of range, get duty 0. Returns 0, or a shutdown request with KZ_SHUTDOWN_* in the upper
// byte and the joint number in the lower byte.
u16 kz_joint_loop(kz_joint* joint, const u16* analog);

// Runs kz_joint_loop on the servo's joints.
static inline u16 kz_joints_update(kz_servo* servo, const kz_tick_input* input) {
  return kz_joint_loop(servo->joint, input->analog);
}

#ifdef __cplusplus
}
#endif

#endif
