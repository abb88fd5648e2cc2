// The requests that change something. Each checks everything before it changes anything.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/commands.h"

#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "shared/servo/joints.h"
#include "shared/servo/safety.h"

#define LIMITS_FIELD_LOWER 2  // position of `lower` in the message

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

static kz_outcome enable(kz_servo* servo, const kz_enable* request) {
  u32 bits;
  u8 i;
  if (request->mask != 0) {
    if (servo->shutdown != KZ_SHUTDOWN_NONE) return refuse(KZ_REFUSED_FAULT, servo->shutdown);
    if (servo->supply_bad_ms != 0) return refuse(KZ_REFUSED_FAULT, KZ_SHUTDOWN_UNDERVOLTAGE);
    for (i = 0, bits = request->mask; i < KZ_JOINTS; ++i, bits >>= 1) {
      if ((bits & 1) && servo->joint[i].pot_bad_ms != 0)
        return refuse(KZ_REFUSED_FAULT, KZ_SHUTDOWN_POT);
    }
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
  for (i = 0; i < KZ_JOINTS; ++i, bits >>= 1) {
    kz_joint* joint = &servo->joint[i];
    if (!(bits & 1)) continue;
    joint->kp = kp;
    joint->kd = kd;
  }
  return done;
}

static kz_outcome set_limits(kz_servo* servo, const kz_limits* request) {
  u32 bits = request->mask;
  u8 i;
  if (request->lower > request->upper) return refuse(KZ_REFUSED_RANGE, LIMITS_FIELD_LOWER);
  for (i = 0; i < KZ_JOINTS; ++i, bits >>= 1) {
    if (bits & 1) servo->joint[i].ramp_limit = request->ramp;
  }
  return done;
}

static kz_outcome heartbeat(kz_servo* servo, const kz_heartbeat* request) {
  if (request->watchdog_10ms != 0) servo->watchdog_ms = (u16)(request->watchdog_10ms * 10);
  if (request->reaction != 0) servo->reaction = request->reaction;
  return done;
}

static kz_outcome clear(kz_servo* servo) {
  servo->shutdown = KZ_SHUTDOWN_NONE;
  servo->shutdown_detail = KZ_NO_DETAIL;
  servo->missed_tick = 0;
  return done;
}

// Takes the fields apart into `request`, and checks them against their bounds.
#define TAKE(name)                                        \
  if (!kz_unpack_##name(&request.name, fields, length)) { \
    return refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);       \
  }                                                       \
  wrong = kz_check_##name(&request.name);                 \
  if (wrong != KZ_IN_BOUNDS) return refuse(KZ_REFUSED_RANGE, wrong);

kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length) {
  union {
    kz_enable enable;
    kz_targets targets;
    kz_gains gains;
    kz_limits limits;
    kz_heartbeat heartbeat;
  } request;
  u8 wrong;
  switch (type) {
    case KZ_TYPE_identify:
    case KZ_TYPE_statistics:
    case KZ_TYPE_state:
      return length == 0 ? done : refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
    case KZ_TYPE_stop:
      if (length != 0) return refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
      kz_shutdown(servo, KZ_SHUTDOWN_STOP, KZ_NO_DETAIL);
      return done;
    case KZ_TYPE_clear:
      return length == 0 ? clear(servo) : refuse(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
    case KZ_TYPE_enable:
      TAKE(enable)
      return enable(servo, &request.enable);
    case KZ_TYPE_targets:
      TAKE(targets)
      return go_to_targets(servo, &request.targets);
    case KZ_TYPE_gains:
      TAKE(gains)
      return set_gains(servo, &request.gains);
    case KZ_TYPE_limits:
      TAKE(limits)
      return set_limits(servo, &request.limits);
    case KZ_TYPE_heartbeat:
      TAKE(heartbeat)
      return heartbeat(servo, &request.heartbeat);
    default:
      return refuse(KZ_REFUSED_UNKNOWN_TYPE, KZ_NO_DETAIL);
  }
}
