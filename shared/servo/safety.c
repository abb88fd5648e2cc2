// What switches the motors off without being asked.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/safety.h"

#include "shared/protocol/messages.h"
#include "shared/servo/commands.h"
#include "shared/servo/joints.h"

#define COUNTER_MAX 0xFFFF
#define SUPPLY_MV_PER_CODE (KZ_SUPPLY_FULL_MV / KZ_POT_CODES)

void kz_shutdown(kz_servo* servo, u8 reason, u8 detail) {
  kz_joints_enable(servo, 0);
  if (servo->shutdown != KZ_SHUTDOWN_NONE) return;
  servo->shutdown = reason;
  servo->shutdown_detail = detail;
}

static void watch_link(kz_servo* servo) {
  if (servo->silent_ms < COUNTER_MAX) ++servo->silent_ms;
  if (servo->enabled != 0 && servo->silent_ms >= servo->watchdog_ms) {
    kz_shutdown(servo, KZ_SHUTDOWN_LINK_LOST, KZ_NO_DETAIL);
  }
}

static void watch_supply(kz_servo* servo, u16 code) {
  servo->supply_mv = (u16)(code * SUPPLY_MV_PER_CODE);
  if (servo->supply_mv >= KZ_SUPPLY_LOWEST_MV && servo->supply_mv <= KZ_SUPPLY_HIGHEST_MV) {
    servo->supply_bad_ms = 0;
    return;
  }
  if (servo->supply_bad_ms < KZ_SUPPLY_FAULT_MS) ++servo->supply_bad_ms;
  if (servo->enabled != 0 && servo->supply_bad_ms == KZ_SUPPLY_FAULT_MS) {
    kz_shutdown(
        servo,
        servo->supply_mv < KZ_SUPPLY_LOWEST_MV ? KZ_SHUTDOWN_UNDERVOLTAGE : KZ_SHUTDOWN_OVERVOLTAGE,
        KZ_NO_DETAIL);
  }
}

static void count_missed_ticks(kz_servo* servo, u16 missed) {
  if (missed == 0) return;
  servo->missed_tick = KZ_STATUS_MISSED_TICK;
  if (servo->missed_ticks > COUNTER_MAX - missed) {
    servo->missed_ticks = COUNTER_MAX;
  } else {
    servo->missed_ticks = (u16)(servo->missed_ticks + missed);
  }
}

void kz_safety_update(kz_servo* servo, const kz_tick_input* input) {
  count_missed_ticks(servo, input->missed);
  watch_link(servo);
  watch_supply(servo, input->analog[KZ_ANALOG_SUPPLY]);
}

static u8 moving(const kz_servo* servo) {
  const kz_joint* joint = servo->joint;
  u8 i;
  if (servo->fresh_targets != 0) return 1;
  for (i = 0; i < KZ_JOINTS; ++i) {
    if (joint->on && joint->ramp_left != 0) return 1;
    ++joint;
  }
  return 0;
}

u16 kz_status(const kz_servo* servo) {
  u16 status = (u16)((u16)((u16)servo->shutdown << 8) | servo->missed_tick);
  if (servo->enabled != 0) {
    status |= KZ_STATUS_ENABLED;
    if (moving(servo)) status |= KZ_STATUS_MOVING;
  }
  return status;
}
