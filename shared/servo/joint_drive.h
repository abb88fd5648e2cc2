// Limits a motor drive near soft limits, and converts drives to duty and direction. Inline, for the joint
// loop.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINT_DRIVE_H
#define KAZ_SHARED_SERVO_JOINT_DRIVE_H

#include "shared/servo/servo.h"

#define KZ_DUTY_MAX 255
#define KZ_DRIVE_SHIFT 11  // the unit of a drive is 1/2048 of a count of duty

// The unit of distances is 100 urad, and the unit of rates is 100 urad per 64 ms. A limit bounds the rate of
// a joint that moves toward the limit (joint_loop.h). In these units, the maximum rate is:
// distance + min(distance, KZ_NEAR_LIMIT).
#define KZ_NEAR_LIMIT 1000  // 0.1 rad
// The board brakes a joint only if the joint's rate is above KZ_SLOW (0.5 rad/s). If noise changes the A/D
// code of a resting joint by 1, the measured rate stays below KZ_SLOW.
#define KZ_SLOW 320
// Braking gain, drive per unit of rate. The brake reaches full drive at 4 rad/s above the allowed speed.
#define KZ_BRAKE 204

// Returns the excess of `rate` over the allowed rate; 0 if the rate is allowed. `distance` is the
// distance from the limit toward which the joint moves, unit 100 urad.
static inline u16 kz_excess_rate(u16 distance, u16 rate) {
  distance = (u16)(distance + (distance < KZ_NEAR_LIMIT ? distance : KZ_NEAR_LIMIT));
  return (u16)(rate > distance ? rate - distance : 0);
}

// Applies the soft limits to `drive` and returns the result (joint_loop.h). At a limit, outward drive
// becomes 0. If the joint approaches a limit too fast, the result is at least the braking drive. Units:
// 1/2048 of a count of duty.
static inline s32 kz_hold_back(const kz_joint* joint, s32 drive) {
  const s16 angle = joint->angle;
  const s16 rate = joint->rate;
  const s16 upper = joint->upper;
  const s16 lower = joint->lower;
  if (angle >= upper && drive > 0) drive = 0;
  if (angle <= lower && drive < 0) drive = 0;
  if (rate > KZ_SLOW) {
    const u16 excess = kz_excess_rate((u16)(angle < upper ? upper - angle : 0), (u16)rate);
    const s32 brake = -(s32)((u32)excess * KZ_BRAKE);
    if (excess != 0 && drive > brake) drive = brake;
  } else if (rate < -KZ_SLOW) {
    const u16 excess = kz_excess_rate((u16)(angle > lower ? angle - lower : 0), (u16)-rate);
    const s32 brake = (s32)((u32)excess * KZ_BRAKE);
    if (excess != 0 && drive < brake) drive = brake;
  }
  return drive;
}

// Sets duty and direction of the joint's motor. Rounds `drive` (1/2048 of a count) and saturates at
// KZ_DUTY_MAX.
static inline void kz_put_drive(kz_joint* joint, s32 drive) {
  u32 strength;
  u8 forward = joint->mirrored;
  if (drive > 0) {
    strength = (u32)drive;
    forward ^= 1;
  } else {
    strength = (u32)-drive;
  }
  strength += (u32)1 << (KZ_DRIVE_SHIFT - 1);
  if (strength >= (u32)KZ_DUTY_MAX << KZ_DRIVE_SHIFT) {
    joint->duty = KZ_DUTY_MAX;
  } else {
    // The right shift by 16 only selects the upper word. The H8 does this faster than a right shift by
    // KZ_DRIVE_SHIFT.
    joint->duty = (u8)(strength << (16 - KZ_DRIVE_SHIFT) >> 16);
  }
  joint->forward = forward;
}

#endif
