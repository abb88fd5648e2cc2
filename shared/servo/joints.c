// The joints of the servo: measuring, ramps, position loop.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/joints.h"

#include "shared/board/pot.h"

// Fastest change of angle in a tick that is believed: 51 rad/s, four times what the motor can.
// Keeps the filtered rate inside 16 bits: 64 * 511 = 32704.
#define DELTA_MAX 511
#define DUTY_MAX 255
#define DRIVE_SHIFT 11

// Duty is 255 at full drive. With kp in 1/256 per rad, half the error in 1e-4 rad and the drive in
// 1/2048 of a count: 255 * 2048 * 2 / (256 * 1e4) = 0.408; here times 2^16.
#define KP_SCALE 26739
// With kd in 1/4096 s/rad and the rate in 1/640 rad/s: 255 * 2048 / (4096 * 640) = 0.19921875.
#define KD_SCALE 13056

static s16 scaled(u16 gain, u16 scale) {
  return (s16)(((u32)gain * scale + 0x8000) >> 16);
}

s16 kz_scaled_kp(u16 kp) {
  return scaled(kp, KP_SCALE);
}

s16 kz_scaled_kd(u16 kd) {
  return scaled(kd, KD_SCALE);
}

// 65536 / KP_SCALE = 2.45095, times 2^14; 65536 / KD_SCALE = 5.01961, times 2^13. The gains' bounds
// (KZ_KP_MAX, KZ_KD_MAX) keep the products inside 32 bits and the results inside 16.
u16 kz_unscaled_kp(s16 scaled_kp) {
  return (u16)(((u32)(u16)scaled_kp * 40156 + 0x2000) >> 14);
}

u16 kz_unscaled_kd(s16 scaled_kd) {
  return (u16)(((u32)(u16)scaled_kd * 41121 + 0x1000) >> 13);
}

void kz_joints_init(kz_servo* servo, const kz_startup* startup) {
  // The hands are the joints on the two timer outputs.
  static const u16 kp[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  [index] = (pwm) < 16 ? KZ_KP_DEFAULT : KZ_KP_HAND,
#include "shared/board/joints.def"
#undef KZ_JOINT
  };
  u8 i;
  for (i = 0; i < KZ_JOINTS; ++i) {
    servo->joint[i].kp = kz_scaled_kp(kp[i]);
    servo->joint[i].kd = kz_scaled_kd(KZ_KD_DEFAULT);
    servo->joint[i].ramp_limit = KZ_RAMP_DEFAULT;
    servo->joint[i].lower = kz_board_joints[i].lower;
    servo->joint[i].upper = kz_board_joints[i].upper;
    servo->joint[i].pot_bad_ms = 1;  // not measured yet
    servo->joint[i].pot_centre = startup->pot_centre[i];
    servo->joint[i].pot_scale = startup->pot_scale[i];
    servo->joint[i].pot_input = kz_board_joints[i].analog;
    servo->joint[i].mirrored = kz_board_joints[i].mirrored;
  }
}

void kz_joints_enable(kz_servo* servo, u32 mask) {
  kz_joint* joint = servo->joint;
  u8 i;
  servo->enabled = mask;
  servo->raw_ms = 0;
  if (mask == 0) servo->holding = 0;
  servo->fresh_targets &= mask;
  for (i = 0; i < KZ_JOINTS; ++i) {
    const u8 on = (u8)(mask & 1);
    if (on && !joint->on) {
      joint->command = joint->angle;
      joint->target = joint->angle;
      joint->ramp_left = 0;
    }
    if (!on) {  // a joint that goes off does so in this tick
      joint->duty = 0;
      joint->forward = 0;
    }
    joint->on = on;
    mask >>= 1;
    ++joint;
  }
}

void kz_joints_hold(kz_servo* servo) {
  kz_joint* joint = servo->joint;
  u8 left;
  servo->fresh_targets = 0;
  for (left = KZ_JOINTS; left != 0; --left) {
    joint->ramp_left = 0;
    joint->target = joint->command;
    ++joint;
  }
}

u8 kz_joint_flags(const kz_servo* servo, u8 number) {
  const kz_joint* joint = kz_joint_of(servo, number);
  u8 flags = 0;
  if (joint->on) {
    flags |= KZ_JOINT_ON;
    if (joint->ramp_left != 0 || (servo->fresh_targets >> number & 1)) flags |= KZ_JOINT_MOVING;
  }
  if (joint->pot_bad_ms != 0) flags |= KZ_JOINT_POT;
  if (joint->angle <= joint->lower || joint->angle >= joint->upper) flags |= KZ_JOINT_AT_LIMIT;
  return flags;
}

s16 kz_joint_drive(const kz_joint* joint) {
  const s16 duty = (s16)joint->duty;
  return joint->forward == joint->mirrored ? (s16)-duty : duty;
}

void kz_joint_drive_raw(kz_joint* joint, s16 drive) {
  if (drive > 0 && joint->angle >= joint->upper) drive = 0;
  if (drive < 0 && joint->angle <= joint->lower) drive = 0;
  joint->forward = (u8)(drive > 0 ? joint->mirrored ^ 1 : joint->mirrored);
  joint->duty = (u8)(drive > 0 ? drive : -drive);
}

u8 kz_joint_load(const kz_joint* joint) {
  return joint->duty;
}

// Straight way to the joint's target in `duration_ms`, or more slowly if the joint's ramp demands
// that.
static inline void start_ramp(kz_joint* joint, u16 duration_ms) {
  const s16 target = joint->target;
  const u8 down = (u8)(target < joint->command);
  const u16 from = (u16)joint->command;
  // Two limits can be further apart than 32767, but not than 65535.
  const u16 distance = (u16)(down ? from - (u16)target : (u16)target - from);
  u16 whole;
  if (distance == 0) {
    joint->ramp_left = 0;
    return;
  }
  if ((u32)joint->ramp_limit * duration_ms < distance) {
    duration_ms = (u16)((u16)(distance - 1) / joint->ramp_limit + 1);
  }
  whole = (u16)(distance / duration_ms);
  joint->ramp_left = duration_ms;
  joint->ramp_time = duration_ms;
  joint->ramp_rest = (u16)(distance % duration_ms);
  joint->ramp_room = duration_ms;
  // Negative steps as what they are modulo 2^16.
  joint->ramp_whole = down ? (u16)-whole : whole;
  joint->ramp_extra = down ? (u16)-1 : 1;
}

void kz_joints_start_ramps(kz_servo* servo) {
  kz_joint* joint = servo->joint;
  u32 fresh = servo->fresh_targets;
  const u16 duration_ms = servo->target_ms;
  u8 i;
  servo->fresh_targets = 0;
  for (i = 0; i < KZ_JOINTS; ++i) {
    if (fresh & 1) start_ramp(joint, duration_ms);
    fresh >>= 1;
    ++joint;
  }
}

// `left` steps remain; after the last the command is exactly the target.
static inline void follow_ramp(kz_joint* joint, u16 left) {
  u16 command = (u16)((u16)joint->command + joint->ramp_whole);
  const u16 room = joint->ramp_room;
  const u16 rest = joint->ramp_rest;
  if (rest < room) {
    joint->ramp_room = (u16)(room - rest);
  } else {
    joint->ramp_room = (u16)(room + (u16)(joint->ramp_time - rest));
    command = (u16)(command + joint->ramp_extra);
  }
  joint->ramp_left = (u16)(left - 1);
  joint->command = (s16)command;
}

static inline void measure(kz_joint* joint, s16 angle) {
  s16 delta = (s16)((u16)angle - (u16)joint->angle);
  const s16 rate = joint->rate;
  if (joint->pot_bad_ms != 0) {  // the angle before means nothing
    joint->pot_bad_ms = 0;
    delta = 0;
  }
  if (delta > DELTA_MAX) delta = DELTA_MAX;
  if (delta < -DELTA_MAX) delta = -DELTA_MAX;
  joint->rate = (s16)(rate - (s16)(rate >> 3) + (s16)(delta * 8));
  joint->angle = angle;
}

// d = kp * (command - angle) - kd * rate, limited to full duty.
static inline void control(kz_joint* joint) {
  // Halved, so that the widest error fits 16 bits; the resolution of the potentiometer is 16 times
  // coarser.
  const s32 error = ((s32)joint->command - joint->angle) >> 1;
  s32 drive;
  u32 strength;
  u8 forward = joint->mirrored;
  drive = (s32)(s16)error * joint->kp - (s32)joint->rate * joint->kd;
  if (drive > 0) {
    strength = (u32)drive;
    forward ^= 1;
  } else {
    strength = (u32)-drive;
  }
  strength += (u32)1 << (DRIVE_SHIFT - 1);
  if (strength >= (u32)DUTY_MAX << DRIVE_SHIFT) {
    joint->duty = DUTY_MAX;
  } else {
    joint->duty = (u8)(strength << (16 - DRIVE_SHIFT) >> 16);  // the upper half: no shift on the H8
  }
  joint->forward = forward;
}

u16 kz_joints_update(kz_servo* servo, const kz_tick_input* input) {
  kz_joint* joint = servo->joint;
  u8 faulty = 0;  // joints left when the first one with a fault was done
  u8 left;
  for (left = KZ_JOINTS; left != 0; --left) {
    const u16 code = input->analog[joint->pot_input];
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
      // Nobody knows where the joint is: the last angle stays, and the motor gets no power.
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
