// Replies with numbers of many joints: written once, straight to where they are sent from.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/bytes.h"
#include "shared/servo/commands.h"
#include "shared/servo/joints.h"
#include "shared/servo/replies.h"
#include "shared/servo/safety.h"

// 1000 / 640 = 25 / 16: a rate is 1/640 rad/s, a speed 1/1000.
static s16 speed_of(s16 rate) {
  const s32 speed = (s32)rate * 25 >> 4;
  if (speed > 32767) return 32767;
  if (speed < -32767) return -32767;
  return (s16)speed;
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
  const u8 count = kz_count_joints(mask);
  const u8 bytes = (u8)(2 * count);
  u8* angle;
  u8* speed;
  u8* duty;
  u8* load;
  u8 i;
  to = kz_put_head(servo, to);
  angle = kz_put_u32(to, mask);
  speed = angle + bytes;
  duty = speed + bytes;
  load = duty + bytes;
  for (i = 0; mask != 0; ++i) {
    if (mask & 1) {
      angle = kz_put_s16(angle, joint->angle);
      speed = kz_put_s16(speed, speed_of(joint->rate));
      duty = kz_put_s16(duty, kz_joint_drive(joint));
      load[0] = kz_joint_load(joint);
      load[count] = kz_joint_flags(servo, i);
      ++load;
    }
    mask >>= 1;
    ++joint;
  }
  return load + count;
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
