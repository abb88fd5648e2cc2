// Protection of the motors: load, stall, and heat by the model I2t, each joint every 16 ms.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/protection.h"

#include "shared/servo/joint_loop.h"
#include "shared/servo/shutdown.h"

#define LOAD_MAX 255
#define LIMITS_MS 4
// A joint faster than 8 rad/s counts as near a limit wherever it is: so limits, at most 24434 from 0, plus
// this plus KZ_FAR_FROM_LIMIT fit 16 bits.
#define FAST 5200
// Voltage and speed in the same unit, 2^14 of it a count of load: 10 V give 16,250 (supply_mv * 1.625)
// for each count of duty, full duty 4,143,750; a motor without load turns at 12.97 rad/s then, which
// is a rate of 8,301.
#define BACK_EMF 499

static u16 load_of(const kz_joint* joint, s16 volts) {
  s16 drive = (s16)joint->duty;
  s32 torque;
  if (joint->forward == joint->mirrored) drive = (s16)-drive;
  torque = (s32)drive * volts - (s32)joint->rate * BACK_EMF;
  if (torque < 0) torque = -torque;
  return (u16)((u32)torque << 2 >> 16);  // the upper half: no shift on the H8
}

static inline void warm(kz_joint* joint, u16 load) {
  u32 heat = joint->heat;
  heat -= (u32)(u16)(heat >> 16) * 8;
  heat += (u32)load * load;
  joint->heat = heat;
}

static inline void watch_stall(kz_joint* joint, u16 load) {
  const s16 angle = joint->angle;
  const u16 moved = (u16)((u16)(angle - joint->stall_angle) + KZ_STALL_ANGLE);
  const u8 stalled = joint->stalled;
  if (moved > 2 * KZ_STALL_ANGLE) {
    joint->stall_angle = angle;
    joint->stalled = 0;
  } else if (load >= KZ_STALL_LOAD) {
    if (stalled < KZ_STALL_COUNT) joint->stalled = (u8)(stalled + 1);
  } else if (stalled != 0) {
    joint->stalled = (u8)(stalled - 1);
  }
}

static u16 watch_motors(kz_servo* servo) {
  u8 number = (u8)(servo->phase & (KZ_PROTECTION_MS - 1));
  kz_joint* joint = kz_joint_at(servo, number);
  const u16 supply_mv = servo->supply_mv;
  const s16 volts = (s16)(supply_mv + (u16)(supply_mv >> 1) + (u16)(supply_mv >> 3));
  // With the bridges open no current flows, however the joints are turned.
  const u8 powered = kz_motors_on(servo);
  u16 fault = 0;
  for (; number < KZ_JOINTS; number = (u8)(number + KZ_PROTECTION_MS)) {
    u16 load = 0;
    if (powered) {
      load = load_of(joint, volts);
      watch_stall(joint, load);
      if (joint->stalled == KZ_STALL_COUNT) fault = (u16)(KZ_SHUTDOWN_STALL << 8 | number);
    } else {
      joint->stalled = 0;
    }
    joint->load = (u8)(load < LOAD_MAX ? load : LOAD_MAX);
    warm(joint, load);
    if (powered && (u16)(joint->heat >> 16) >= KZ_HEAT_FULL) {
      fault = (u16)(KZ_SHUTDOWN_OVERLOAD << 8 | number);
    }
    joint += KZ_PROTECTION_MS;
  }
  return fault;
}

static void watch_limits(kz_servo* servo) {
  u8 number = (u8)(servo->phase & (LIMITS_MS - 1));
  kz_joint* joint = kz_joint_at(servo, number);
  for (; number < KZ_JOINTS; number = (u8)(number + LIMITS_MS)) {
    const s16 lower = joint->lower;
    const s16 angle = joint->angle;
    s16 far = joint->rate;
    u8 constrained = (u8)(joint->constrained & KZ_CONSTRAINED_BY_FRICTION);
    if (far < 0) far = (s16)-far;
    if (far > FAST) constrained |= KZ_CONSTRAINED_NEAR_LIMIT;
    far = (s16)(far + KZ_FAR_FROM_LIMIT);
    if (angle <= (s16)(lower + far) || angle >= (s16)(joint->upper - far)) {
      constrained |= KZ_CONSTRAINED_NEAR_LIMIT;
    }
    joint->constrained = constrained;
    joint += LIMITS_MS;
  }
}

u16 kz_protection_update(kz_servo* servo) {
  watch_limits(servo);
  return watch_motors(servo);
}
