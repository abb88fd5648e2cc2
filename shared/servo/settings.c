// Requests that set how joints behave: gains, limits, calibration.
// SPDX-License-Identifier: Apache-2.0
#include "shared/board/table.h"
#include "shared/protocol/bytes.h"
#include "shared/servo/handlers.h"
#include "shared/servo/joint_loop.h"
#include "shared/servo/joints.h"
#include "shared/servo/shutdown.h"

#define LIMITS_FIELD_LOWER 2  // position of `lower` in the message

kz_outcome kz_do_gains(kz_servo* servo, const kz_gains* request) {
  const s16 kp = kz_scaled_kp(request->kp);
  const s16 kd = kz_scaled_kd(request->kd);
  const u8 constrained = (request->dead_band | request->friction) != 0
                             ? KZ_CONSTRAINED_NEAR_LIMIT | KZ_CONSTRAINED_BY_FRICTION
                             : KZ_CONSTRAINED_NEAR_LIMIT;
  const u16 friction_drive = (u16)(request->friction << 8);
  kz_joint* joint = servo->joint;
  u32 bits;
  for (bits = request->mask; bits != 0; bits >>= 1) {
    if (bits & 1) {
      joint->kp = kp;
      joint->kd = kd;
      joint->dead_band = request->dead_band;
      joint->friction = request->friction;
      joint->friction_drive = friction_drive;
      joint->constrained = constrained;
    }
    ++joint;
  }
  return KZ_DONE;
}

kz_outcome kz_do_limits(kz_servo* servo, const kz_limits* request) {
  const kz_board_joint* board = kz_board_joints;
  kz_joint* joint = servo->joint;
  const u16 ramp = request->ramp;
  const s16 lower = request->lower;
  const s16 upper = request->upper;
  u32 bits;
  if (lower > upper) return KZ_REFUSE(KZ_REFUSED_RANGE, LIMITS_FIELD_LOWER);
  for (bits = request->mask; bits != 0; bits >>= 1) {
    if (bits & 1) {
      // Each cut to the mechanics at both ends: a range beyond them becomes one point.
      const s16 min = board->lower;
      const s16 max = board->upper;
      joint->ramp_limit = ramp;
      joint->constrained |= KZ_CONSTRAINED_NEAR_LIMIT;
      joint->lower = lower < min ? min : lower > max ? max : lower;
      joint->upper = upper > max ? max : upper < min ? min : upper;
    }
    ++joint;
    ++board;
  }
  return KZ_DONE;
}

static u8 near(s16 value, s16 nominal, s16 tolerance) {
  const s32 difference = (s32)value - nominal;
  return (u8)(difference <= tolerance && difference >= -(s32)tolerance);
}

// Straight from the bytes, as with `targets`: this is the longest request of all.
kz_outcome kz_do_calibrate(kz_servo* servo, const u8* fields, u8 length) {
  const kz_board_joint* board = kz_board_joints;
  kz_joint* joint = servo->joint;
  const u8* centre = fields + sizeof(u32);
  const u8* scale;
  u32 mask;
  u32 bits;
  u8 i;
  if (length < sizeof(u32)) return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
  mask = kz_get_u32(fields);
  bits = mask & KZ_ALL_JOINTS;
  i = kz_count_joints(bits);
  if (length != (u8)(sizeof(u32) + 4 * i)) return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
  if (bits != mask) return KZ_REFUSE(KZ_REFUSED_RANGE, 0);
  if (kz_motors_on(servo)) return KZ_REFUSE(KZ_REFUSED_ARMED, KZ_NO_DETAIL);
  scale = centre + 2 * i;
  for (i = 0; bits != 0; ++i) {
    if (bits & 1) {
      if (!near(kz_get_s16(centre), board->pot_centre, KZ_CENTRE_TOLERANCE) ||
          !near(kz_get_s16(scale), board->pot_scale, KZ_POT_HALF_SPAN / 4)) {
        return KZ_REFUSE(KZ_REFUSED_RANGE, i);
      }
      centre += 2;
      scale += 2;
    }
    bits >>= 1;
    ++board;
  }
  scale = centre;
  centre = fields + sizeof(u32);
  for (bits = mask; bits != 0; bits >>= 1) {
    if (bits & 1) {
      joint->constrained |= KZ_CONSTRAINED_NEAR_LIMIT;  // it may be at one now
      joint->pot_centre = kz_get_s16(centre);
      joint->pot_scale = kz_get_s16(scale);
      joint->rate = 0;
      joint->pot_bad_ms = 1;  // not measured yet: the previous angle is invalid
      centre += 2;
      scale += 2;
    }
    ++joint;
  }
  return KZ_DONE;
}
