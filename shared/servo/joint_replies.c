// Replies with numbers of many joints, written straight to the sender's bytes.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/joint_replies.h"

#include "shared/protocol/bytes.h"
#include "shared/servo/joints.h"
#include "shared/servo/status.h"

#define FASTEST 20970  // rate whose speed just fits 16 bits

// A rate is 1/640 rad/s, a speed 1/1000: times 25 / 16, without a multiplication.
static inline s16 speed_of(s16 rate) {
  if (rate > FASTEST) return 32767;
  if (rate < -FASTEST) return -32767;
  return (s16)(rate + (s16)(rate >> 1) + (s16)(rate >> 4));
}

u8* kz_put_head(const kz_servo* servo, u8* to) {
  to = kz_put_u32(to, servo->tick);
  return kz_put_u16(to, kz_status(servo));
}

u8* kz_put_state(const kz_servo* servo, u8* to) {
  const kz_joint* joint = servo->joint;
  u8 left;
  to = kz_put_head(servo, to);
  to = kz_put_u16(to, servo->supply_mv);
  for (left = KZ_JOINTS; left != 0; --left) {
    to = kz_put_s16(to, joint->angle);
    ++joint;
  }
  return to;
}

u8* kz_put_read_targets(const kz_servo* servo, u32 mask, u8* to) {
  const kz_joint* joint = servo->joint;
  to = kz_put_head(servo, to);
  to = kz_put_u32(to, mask);
  for (; mask != 0; mask >>= 1) {
    if (mask & 1) to = kz_put_s16(to, joint->on ? joint->target : joint->angle);
    ++joint;
  }
  return to;
}

u8* kz_put_joints(const kz_servo* servo, u32 mask, u8* to) {
  const kz_joint* joint = servo->joint;
  const u32 bytes = (u32)(2 * kz_count_joints(mask));
  to = kz_put_head(servo, to);
  to = kz_put_u32(to, mask);
  for (; mask != 0; mask >>= 1) {
    if (mask & 1) {
      u8* place = to;
      s16 drive = (s16)joint->duty;
      kz_put_s16(place, joint->angle);
      place += bytes;
      kz_put_s16(place, speed_of(joint->rate));
      place += bytes;
      if (joint->forward == joint->mirrored) drive = (s16)-drive;
      kz_put_s16(place, drive);
      to += 2;
    }
    ++joint;
  }
  return to + 2 * bytes;
}

u8* kz_put_joints_rest(const kz_servo* servo, u32 mask, u8* to) {
  const kz_joint* joint = servo->joint;
  const u8 count = kz_count_joints(mask);
  const u32 fresh = servo->fresh_targets;
  u32 bit;
  for (bit = 1; mask != 0; bit <<= 1) {
    if (mask & 1) {
      to[0] = kz_joint_load(joint);
      to[count] = kz_joint_flags(joint, (u8)((fresh & bit) != 0));
      ++to;
    }
    mask >>= 1;
    ++joint;
  }
  return to + count;
}

u8* kz_put_calibration(const kz_servo* servo, const kz_tick_input* input, u8* to) {
  const kz_joint* joint = servo->joint;
  u8* scale;
  u8 left;
  to = kz_put_head(servo, to);
  to = kz_put_u8(to, servo->calibration);
  to = kz_put_u16(to, input->calibration_sequence);
  to = kz_put_u8(to, input->erases_a);
  to = kz_put_u8(to, input->erases_b);
  scale = to + 2 * KZ_JOINTS;
  for (left = KZ_JOINTS; left != 0; --left) {
    to = kz_put_s16(to, joint->pot_centre);
    scale = kz_put_s16(scale, joint->pot_scale);
    ++joint;
  }
  return scale;
}
