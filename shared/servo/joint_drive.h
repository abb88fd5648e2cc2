// From a wish for drive to duty and direction, as the soft limits allow; inline for the loop.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINT_DRIVE_H
#define KAZ_SHARED_SERVO_JOINT_DRIVE_H

#include "shared/servo/servo.h"

#define KZ_DUTY_MAX 255
#define KZ_DRIVE_SHIFT 11  // a drive has 2048 to a count of duty

// Rates are 1/64 of 100 urad/ms, so a way of 100 urad allows a rate of 1 if T is 64 ms.
#define KZ_NEAR_LIMIT 1000  // 100 urad: on this last way T is half
// Slower than that, 0.5 rad/s, nothing is held back. More than the flicker of one code gives.
#define KZ_SLOW 320
// Full drive against 4 rad/s too fast, in 1/2048 of a count for a unit of rate.
#define KZ_BRAKE 204

// What of a rate towards a limit is too fast, `way` before it.
static inline u16 kz_too_fast(u16 way, u16 rate) {
  way = (u16)(way + (way < KZ_NEAR_LIMIT ? way : KZ_NEAR_LIMIT));
  return (u16)(rate > way ? rate - way : 0);
}

// `drive`, in 1/2048 of a count, as far as the soft limits allow it.
static inline s32 kz_hold_back(const kz_joint* joint, s32 drive) {
  const s16 angle = joint->angle;
  const s16 rate = joint->rate;
  const s16 upper = joint->upper;
  const s16 lower = joint->lower;
  if (angle >= upper && drive > 0) drive = 0;
  if (angle <= lower && drive < 0) drive = 0;
  if (rate > KZ_SLOW) {
    const u16 excess = kz_too_fast((u16)(angle < upper ? upper - angle : 0), (u16)rate);
    const s32 brake = -(s32)((u32)excess * KZ_BRAKE);
    if (excess != 0 && drive > brake) drive = brake;
  } else if (rate < -KZ_SLOW) {
    const u16 excess = kz_too_fast((u16)(angle > lower ? angle - lower : 0), (u16)-rate);
    const s32 brake = (s32)((u32)excess * KZ_BRAKE);
    if (excess != 0 && drive < brake) drive = brake;
  }
  return drive;
}

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
    // The upper half: no shift on the H8.
    joint->duty = (u8)(strength << (16 - KZ_DRIVE_SHIFT) >> 16);
  }
  joint->forward = forward;
}

#endif
