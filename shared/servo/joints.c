// The joints of the servo: settings, switching on and off, starts of ramps.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/joints.h"

#include "shared/board/table.h"
#include "shared/servo/joint_drive.h"
#include "shared/servo/joint_loop.h"

#define THIRD (KZ_JOINTS / 3)
#define THIRD_MASK ((1 << THIRD) - 1)

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
    // The rest is 0: no dead band, no friction, cold.
    servo->joint[i].kp = kz_scaled_kp(kp[i]);
    servo->joint[i].kd = kz_scaled_kd(KZ_KD_DEFAULT);
    servo->joint[i].ramp_limit = KZ_RAMP_DEFAULT;
    servo->joint[i].lower = kz_board_joints[i].lower;
    servo->joint[i].upper = kz_board_joints[i].upper;
    servo->joint[i].constrained = KZ_CONSTRAINED_NEAR_LIMIT;
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

s16 kz_joint_drive(const kz_joint* joint) {
  const s16 duty = (s16)joint->duty;
  return joint->forward == joint->mirrored ? (s16)-duty : duty;
}

void kz_joint_drive_raw(kz_joint* joint, s16 drive) {
  kz_put_drive(joint, kz_hold_back(joint, (s32)drive * (1 << KZ_DRIVE_SHIFT)));
}

u8 kz_joint_load(const kz_joint* joint) {
  return joint->load;
}

// Starts a linear ramp to the joint's target in target_ms, or a slower one if the joint's maximum rate
// demands it.
static inline void start_ramp(kz_joint* joint) {
  u16 duration_ms = joint->target_ms;
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
  const u32 fresh = servo->fresh_targets;
  u8 bits = (u8)(fresh & THIRD_MASK);
  if (bits != 0) {
    servo->fresh_targets = fresh & ~(u32)THIRD_MASK;
  } else {
    joint += THIRD;
    bits = (u8)((u16)((u16)fresh >> THIRD) & THIRD_MASK);
    if (bits != 0) {
      servo->fresh_targets = fresh & ~((u32)THIRD_MASK << THIRD);
    } else {
      joint += THIRD;
      bits = (u8)(fresh >> (2 * THIRD));
      servo->fresh_targets = 0;
    }
  }
  for (; bits != 0; bits = (u8)(bits >> 1)) {
    if (bits & 1) start_ramp(joint);
    ++joint;
  }
}

u8 kz_count_joints(u32 mask) {
  // In two halves: the H8 does 16 bits at once.
  u16 bits = (u16)mask;
  u8 count = 0;
  for (; bits != 0; bits = (u16)(bits & (u16)(bits - 1))) ++count;
  for (bits = (u16)(mask >> 16); bits != 0; bits = (u16)(bits & (u16)(bits - 1))) ++count;
  return count;
}
