// Requests that set how joints behave: gains, limits.
// SPDX-License-Identifier: Apache-2.0
#include "shared/board/table.h"
#include "shared/servo/commands.h"
#include "shared/servo/joints.h"

#define LIMITS_FIELD_LOWER 2  // position of `lower` in the message

kz_outcome kz_do_gains(kz_servo* servo, const kz_gains* request) {
  const s16 kp = kz_scaled_kp(request->kp);
  const s16 kd = kz_scaled_kd(request->kd);
  kz_joint* joint = servo->joint;
  u32 bits;
  for (bits = request->mask; bits != 0; bits >>= 1) {
    if (bits & 1) {
      joint->kp = kp;
      joint->kd = kd;
      joint->dead_band = request->dead_band;
      joint->friction = request->friction;
    }
    ++joint;
  }
  return KZ_DONE;
}

static s16 cut(s16 value, s16 low, s16 high) {
  if (value < low) return low;
  return value > high ? high : value;
}

kz_outcome kz_do_limits(kz_servo* servo, const kz_limits* request) {
  const kz_board_joint* board = kz_board_joints;
  kz_joint* joint = servo->joint;
  u32 bits;
  if (request->lower > request->upper) return KZ_REFUSE(KZ_REFUSED_RANGE, LIMITS_FIELD_LOWER);
  for (bits = request->mask; bits != 0; bits >>= 1) {
    if (bits & 1) {
      joint->ramp_limit = request->ramp;
      joint->lower = cut(request->lower, board->lower, board->upper);
      joint->upper = cut(request->upper, board->lower, board->upper);
    }
    ++joint;
    ++board;
  }
  return KZ_DONE;
}
