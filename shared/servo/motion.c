// Requests that move joints or stop them: enable, targets, stop, clear, heartbeat.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/bytes.h"
#include "shared/servo/handlers.h"
#include "shared/servo/joints.h"
#include "shared/servo/safety.h"
#include "shared/servo/shutdown.h"

// Where the fields of `targets` stand.
#define TARGETS_DURATION 4
#define TARGETS_ANGLES 6

static u8 lowest_bit(u32 mask) {
  u8 bit = 0;
  while (bit < 31 && !(mask & 1)) {
    mask >>= 1;
    ++bit;
  }
  return bit;
}

kz_outcome kz_do_enable(kz_servo* servo, const kz_enable* request) {
  const u32 mask = request->mask;
  if (mask != 0) {
    u8 reason = servo->shutdown;
    if (reason == KZ_SHUTDOWN_NONE) reason = kz_active_fault(servo, mask);
    if (reason != KZ_SHUTDOWN_NONE) return KZ_REFUSE(KZ_REFUSED_FAULT, reason);
  }
  kz_joints_enable(servo, mask);
  return KZ_DONE;
}

// Straight from the bytes: the longest request that comes a hundred times a second is not copied.
kz_outcome kz_do_targets(kz_servo* servo, const u8* fields, u8 length) {
  kz_joint* joint = servo->joint;
  const u8* angle = fields + TARGETS_ANGLES;
  u32 mask;
  u32 bits;
  u16 duration_ms;
  u8 i;
  if (length < TARGETS_ANGLES) return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
  mask = kz_get_u32(fields);
  bits = mask & KZ_ALL_JOINTS;
  if (length != (u8)(TARGETS_ANGLES + 2 * kz_count_joints(bits))) {
    return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);
  }
  if (bits != mask) return KZ_REFUSE(KZ_REFUSED_RANGE, 0);
  if (servo->shutdown != KZ_SHUTDOWN_NONE) return KZ_REFUSE(KZ_REFUSED_FAULT, servo->shutdown);
  if (mask & ~servo->enabled) {
    return KZ_REFUSE(KZ_REFUSED_DISABLED, lowest_bit(mask & ~servo->enabled));
  }
  if (mask == 0) return KZ_DONE;
  for (i = 0; bits != 0; ++i) {
    if (bits & 1) {
      const s16 target = kz_get_s16(angle);
      if (target < joint->lower || target > joint->upper) return KZ_REFUSE(KZ_REFUSED_LIMIT, i);
      angle += 2;
    }
    bits >>= 1;
    ++joint;
  }
  servo->fresh_targets |= mask;
  duration_ms = kz_get_u16(fields + TARGETS_DURATION);
  bits = mask;
  angle = fields + TARGETS_ANGLES;
  for (joint = servo->joint; bits != 0; ++joint) {
    if (bits & 1) {
      joint->target = kz_get_s16(angle);
      joint->target_ms = duration_ms;
      angle += 2;
    }
    bits >>= 1;
  }
  return KZ_DONE;
}

kz_outcome kz_do_stop(kz_servo* servo, const kz_stop* request) {
  (void)request;
  kz_shutdown(servo, KZ_SHUTDOWN_STOP, KZ_NO_DETAIL);
  return KZ_DONE;
}

kz_outcome kz_do_clear(kz_servo* servo, const kz_clear* request) {
  (void)request;
  if (kz_cause_present(servo)) return KZ_REFUSE(KZ_REFUSED_FAULT, servo->shutdown);
  if (servo->holding) kz_joints_enable(servo, 0);
  servo->shutdown = KZ_SHUTDOWN_NONE;
  servo->shutdown_detail = KZ_NO_DETAIL;
  servo->shutdown_tick = 0;
  servo->missed_tick = 0;
  return KZ_DONE;
}

kz_outcome kz_do_heartbeat(kz_servo* servo, const kz_heartbeat* request) {
  if (request->watchdog_10ms != 0) servo->watchdog_ms = (u16)((u16)request->watchdog_10ms * 10);
  if (request->reaction != 0) servo->reaction = request->reaction;
  return KZ_DONE;
}
