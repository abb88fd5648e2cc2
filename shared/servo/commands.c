// The requests that change something. Each checks everything before it changes anything.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/commands.h"

#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "shared/servo/joints.h"

#define WATCHDOG_10MS_MAX 100
#define GAINS_FIELD_RAMP 3  // position of `ramp` in the message

static const kz_outcome done = {0, KZ_NO_DETAIL};

static kz_outcome refuse(u8 reason, u8 detail) {
  kz_outcome outcome;
  outcome.reason = reason;
  outcome.detail = detail;
  return outcome;
}

static u8 lowest_bit(u32 mask) {
  u8 bit = 0;
  while (bit < 31 && !(mask & 1)) {
    mask >>= 1;
    ++bit;
  }
  return bit;
}

// Joints that the board does not have.
static u32 beyond(u32 mask) {
  return mask >> KZ_JOINTS << KZ_JOINTS;
}

static kz_outcome enable(kz_servo* servo, const kz_enable* request) {
  u32 bits;
  u8 i;
  if (beyond(request->mask)) return refuse(KZ_REFUSED_RANGE, lowest_bit(beyond(request->mask)));
  if (request->mask != 0) {
    if (servo->supply_bad_ms != 0) return refuse(KZ_REFUSED_FAULT, KZ_NO_DETAIL);
    for (i = 0, bits = request->mask; i < KZ_JOINTS; ++i, bits >>= 1) {
      if ((bits & 1) && servo->joint[i].pot_bad_ms != 0) return refuse(KZ_REFUSED_FAULT, i);
    }
    servo->faults = 0;
  }
  kz_joints_enable(servo, request->mask);
  return done;
}

static kz_outcome go_to_targets(kz_servo* servo, const kz_targets* request) {
  const u32 off = request->mask & ~servo->enabled;
  const kz_board_joint* board = kz_board_joints;
  const s16* angle = request->angle;
  kz_joint* joint = servo->joint;
  u32 bits = request->mask;
  u8 i;
  if (beyond(bits)) return refuse(KZ_REFUSED_RANGE, lowest_bit(beyond(bits)));
  if (off) return refuse(KZ_REFUSED_DISABLED, lowest_bit(off));
  for (i = 0; i < KZ_JOINTS; ++i) {
    if ((bits & 1) && (*angle < board->lower || *angle > board->upper)) {
      return refuse(KZ_REFUSED_LIMIT, i);
    }
    bits >>= 1;
    ++board;
    ++angle;
  }
  if (servo->fresh_targets != 0) kz_joints_start_ramps(servo);  // a second message in one tick
  servo->fresh_targets = request->mask;
  servo->target_ms = request->duration_ms;
  bits = request->mask;
  angle = request->angle;
  for (i = 0; i < KZ_JOINTS; ++i) {
    if (bits & 1) joint->target = *angle;
    bits >>= 1;
    ++joint;
    ++angle;
  }
  return done;
}

static kz_outcome set_gains(kz_servo* servo, const kz_gains* request) {
  const s16 kp = kz_scaled_kp(request->kp);
  const s16 kd = kz_scaled_kd(request->kd);
  u32 bits = request->mask;
  u8 i;
  if (beyond(bits)) return refuse(KZ_REFUSED_RANGE, lowest_bit(beyond(bits)));
  if (request->ramp == 0) return refuse(KZ_REFUSED_RANGE, GAINS_FIELD_RAMP);
  for (i = 0; i < KZ_JOINTS; ++i, bits >>= 1) {
    kz_joint* joint = &servo->joint[i];
    if (!(bits & 1)) continue;
    joint->kp = kp;
    joint->kd = kd;
    joint->ramp_limit = request->ramp;
  }
  return done;
}

static kz_outcome heartbeat(kz_servo* servo, const kz_heartbeat* request) {
  if (request->watchdog_ms_10 > WATCHDOG_10MS_MAX) return refuse(KZ_REFUSED_RANGE, 0);
  if (request->watchdog_ms_10 != 0) servo->watchdog_ms = (u16)(request->watchdog_ms_10 * 10);
  return done;
}

kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length) {
  union {
    kz_enable enable;
    kz_targets targets;
    kz_gains gains;
    kz_heartbeat heartbeat;
  } request;
  switch (type) {
    case KZ_TYPE_identify:
    case KZ_TYPE_state:
      return length == 0 ? done : refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
    case KZ_TYPE_enable:
      if (!kz_unpack_enable(&request.enable, fields, length)) break;
      return enable(servo, &request.enable);
    case KZ_TYPE_targets:
      if (!kz_unpack_targets(&request.targets, fields, length)) break;
      return go_to_targets(servo, &request.targets);
    case KZ_TYPE_gains:
      if (!kz_unpack_gains(&request.gains, fields, length)) break;
      return set_gains(servo, &request.gains);
    case KZ_TYPE_heartbeat:
      if (!kz_unpack_heartbeat(&request.heartbeat, fields, length)) break;
      return heartbeat(servo, &request.heartbeat);
    default:
      return refuse(KZ_REFUSED_UNKNOWN_TYPE, KZ_NO_DETAIL);
  }
  return refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
}
