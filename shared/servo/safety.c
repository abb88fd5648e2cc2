// Link watchdog, missed ticks, active faults.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/safety.h"

#include "shared/servo/health.h"
#include "shared/servo/joints.h"
#include "shared/servo/shutdown.h"
#include "shared/servo/status.h"
#include "shared/servo/telemetry.h"

#define COUNTER_MAX 0xFFFF

// Only joints can be held. While they are, silence is nothing new.
static void link_lost(kz_servo* servo) {
  kz_telemetry_end(servo);
  if (servo->holding || !kz_motors_on(servo)) return;
  if (servo->reaction == KZ_REACTION_HOLD && servo->enabled != 0) {
    kz_joints_hold(servo);
    kz_latch_shutdown(servo, KZ_SHUTDOWN_LINK_LOST, KZ_NO_DETAIL);
    servo->holding = KZ_STATUS_HOLDING;
  } else {
    kz_shutdown(servo, KZ_SHUTDOWN_LINK_LOST, KZ_NO_DETAIL);
  }
}

static void count_missed_ticks(kz_servo* servo, u16 missed) {
  servo->missed_tick = KZ_STATUS_MISSED_TICK;
  // The host was silent in them too.
  servo->silent_ms =
      (u16)(servo->silent_ms > COUNTER_MAX - missed ? COUNTER_MAX : servo->silent_ms + missed);
  if (servo->missed_ticks > COUNTER_MAX - missed) {
    servo->missed_ticks = COUNTER_MAX;
  } else {
    servo->missed_ticks = (u16)(servo->missed_ticks + missed);
  }
}

void kz_safety_update(kz_servo* servo, const kz_tick_input* input) {
  u16 silent_ms;
  // Those that a write to flash took (then there is a result) are no fault.
  if (input->missed != 0 && input->result == KZ_RESULT_NONE) {
    count_missed_ticks(servo, input->missed);
  }
  silent_ms = servo->silent_ms;
  if (silent_ms != COUNTER_MAX) servo->silent_ms = ++silent_ms;
  if (silent_ms >= servo->watchdog_ms) link_lost(servo);
}

u8 kz_active_fault(const kz_servo* servo, u32 mask) {
  const kz_joint* joint = servo->joint;
  const u8 reason = kz_health_active_fault(servo);
  if (reason != KZ_SHUTDOWN_NONE) return reason;
  for (; mask != 0; mask >>= 1) {
    if ((mask & 1) && joint->pot_bad_ms != 0) return KZ_SHUTDOWN_POT;
    ++joint;
  }
  return KZ_SHUTDOWN_NONE;
}

u8 kz_cause_present(const kz_servo* servo) {
  const u8 number = servo->shutdown_detail < KZ_JOINTS ? servo->shutdown_detail : 0;
  const u8 flags = kz_joint_flags(kz_joint_of(servo, number), 0);
  switch (servo->shutdown) {
    case KZ_SHUTDOWN_SELF_TEST:
      return 1;
    case KZ_SHUTDOWN_UNDERVOLTAGE:
    case KZ_SHUTDOWN_OVERVOLTAGE:
      return (u8)(servo->supply_bad_ms != 0);
    case KZ_SHUTDOWN_TEMPERATURE:
      return (u8)(servo->hot_ms != 0);
    case KZ_SHUTDOWN_REFERENCE:
      return (u8)(servo->reference_bad_ms != 0);
    case KZ_SHUTDOWN_POT:
      return (u8)(flags & KZ_JOINT_POT);
    case KZ_SHUTDOWN_STALL:
      return (u8)(flags & KZ_JOINT_STALLED);
    case KZ_SHUTDOWN_OVERLOAD:
      return (u8)(flags & KZ_JOINT_HOT);
    default:
      return 0;
  }
}
