// One millisecond of the joints: measuring, ramps, position loop, soft limits.
// SPDX-License-Identifier: Apache-2.0
//
// The board runs the same in assembler, firmware/joint_loop.S: change both or neither.
#include "shared/servo/joint_loop.h"

#include "shared/board/pot.h"

// `left` steps remain; after the last the command is exactly the target. A ramp that meets a soft
// limit, because that was moved, ends there; or where it is, if that is already outside.
static inline void follow_ramp(kz_joint* joint, u16 left) {
  const s16 before = joint->command;
  u16 next = (u16)((u16)before + joint->ramp_whole);
  const u16 room = joint->ramp_room;
  const u16 rest = joint->ramp_rest;
  const s16 extra = (s16)joint->ramp_extra;
  s16 command;
  if (rest < room) {
    joint->ramp_room = (u16)(room - rest);
  } else {
    joint->ramp_room = (u16)(room + (u16)(joint->ramp_time - rest));
    next = (u16)(next + (u16)extra);
  }
  --left;
  command = (s16)next;
  if (extra >= 0) {
    const s16 upper = joint->upper;
    if (command > upper) {
      command = before > upper ? before : upper;
      joint->target = command;
      left = 0;
    }
  } else {
    const s16 lower = joint->lower;
    if (command < lower) {
      command = before < lower ? before : lower;
      joint->target = command;
      left = 0;
    }
  }
  joint->ramp_left = left;
  joint->command = command;
}

static inline void measure(kz_joint* joint, s16 angle) {
  s16 delta = (s16)((u16)angle - (u16)joint->angle);
  const s16 rate = joint->rate;
  if (joint->pot_bad_ms != 0) {  // the previous angle is invalid
    joint->pot_bad_ms = 0;
    delta = 0;
  }
  if (delta > KZ_DELTA_MAX) delta = KZ_DELTA_MAX;
  if (delta < -KZ_DELTA_MAX) delta = -KZ_DELTA_MAX;
  joint->rate = (s16)(rate - (s16)(rate >> 3) + (s16)(delta * 8));
  joint->angle = angle;
}

// Half the error, so that the widest fits 16 bits; the resolution of the potentiometer is 16 times
// coarser.
static inline s32 follow(const kz_joint* joint, s32 error) {
  return (s32)(s16)(error >> 1) * joint->kp - (s32)joint->rate * joint->kd;
}

static inline s32 follow_constrained(const kz_joint* joint, s32 error) {
  const u16 dead_band = joint->dead_band;
  const s32 friction = (s32)((u32)joint->friction_drive << (KZ_DRIVE_SHIFT - 8));
  s32 drive;
  if (dead_band != 0 && error <= (s32)dead_band && error >= -(s32)dead_band) error = 0;
  drive = follow(joint, error);
  if (error > 0) drive += friction;
  if (error < 0) drive -= friction;
  return (joint->constrained & KZ_CONSTRAINED_NEAR_LIMIT) ? kz_hold_back(joint, drive) : drive;
}

static inline void control(kz_joint* joint) {
  const s32 error = (s32)joint->command - joint->angle;
  kz_put_drive(joint, joint->constrained ? follow_constrained(joint, error) : follow(joint, error));
}

u16 kz_joint_loop(kz_joint* joint, const u16* analog) {
  u8 faulty = 0;  // joints left when the first one with a fault was done
  u8 left;
  for (left = KZ_JOINTS; left != 0; --left) {
    const u16 code = analog[joint->pot_input];
    if ((u16)(code - KZ_POT_LOWEST) <= KZ_POT_HIGHEST - KZ_POT_LOWEST) {
      measure(joint, kz_pot_angle_from(code, joint->pot_centre, joint->pot_scale));
      if (joint->on) {
        const u16 ramp_left = joint->ramp_left;
        if (ramp_left != 0) follow_ramp(joint, ramp_left);
        control(joint);
      } else {
        joint->duty = 0;
        joint->forward = 0;
      }
    } else {
      // The angle is unknown: the last one stays, and the motor is off.
      joint->rate = 0;
      joint->duty = 0;
      joint->forward = 0;
      if (joint->pot_bad_ms < KZ_POT_FAULT_MS) ++joint->pot_bad_ms;
      if (joint->pot_bad_ms == KZ_POT_FAULT_MS && joint->on && faulty == 0) faulty = left;
    }
    ++joint;
  }
  return faulty == 0 ? 0 : (u16)(KZ_SHUTDOWN_POT << 8 | (KZ_JOINTS - faulty));
}
