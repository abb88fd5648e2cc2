// Supply, temperature of the motor drivers, reference of the converter.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/health.h"

#include "shared/servo/shutdown.h"

#define SUPPLY_MV_PER_CODE (KZ_SUPPLY_FULL_MV / KZ_POT_CODES)

// Each is checked in one tick of four.
#define PERIOD_MS 4

void kz_health_init(kz_servo* servo) {
  servo->supply_lowest_mv = 0xFFFF;
  // Not measured yet.
  servo->supply_bad_ms = 1;
  servo->hot_ms = 1;
  servo->reference_bad_ms = 1;
}

static u8 supply_reason(const kz_servo* servo) {
  return servo->supply_mv < KZ_SUPPLY_LOWEST_MV ? KZ_SHUTDOWN_UNDERVOLTAGE
                                                : KZ_SHUTDOWN_OVERVOLTAGE;
}

// Counts for how long something has been bad. If for too long, while motors are on, they go off.
static void watch(kz_servo* servo, u8* counter, u8 bad, u8 limit_ms, u8 reason) {
  if (!bad) {
    *counter = 0;
    return;
  }
  if (*counter < limit_ms) *counter = (u8)(*counter + PERIOD_MS);
  if (*counter >= limit_ms && kz_motors_on(servo)) kz_shutdown(servo, reason, KZ_NO_DETAIL);
}

static void watch_supply(kz_servo* servo, u16 code) {
  const u16 supply_mv = (u16)(code * SUPPLY_MV_PER_CODE);
  servo->supply_mv = supply_mv;
  if (supply_mv < servo->supply_lowest_mv) servo->supply_lowest_mv = supply_mv;
  watch(servo, &servo->supply_bad_ms,
        (u8)(supply_mv < KZ_SUPPLY_LOWEST_MV || supply_mv > KZ_SUPPLY_HIGHEST_MV),
        KZ_SUPPLY_FAULT_MS, supply_reason(servo));
}

static void watch_temperature(kz_servo* servo, u16 code) {
  // Full scale is as many tenths of a degree as there are codes.
  servo->temperature_dc = (s16)code;
  watch(servo, &servo->hot_ms, (u8)(code > KZ_TEMPERATURE_HIGHEST_DC), KZ_TEMPERATURE_FAULT_MS,
        KZ_SHUTDOWN_TEMPERATURE);
}

static void watch_reference(kz_servo* servo, u16 code) {
  servo->reference = code;
  watch(servo, &servo->reference_bad_ms,
        (u8)(code < KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE ||
             code > KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE),
        KZ_REFERENCE_FAULT_MS, KZ_SHUTDOWN_REFERENCE);
}

void kz_health_update(kz_servo* servo, const kz_tick_input* input) {
  const u8 phase = (u8)(servo->phase & (PERIOD_MS - 1));
  // The reference first: if it is wrong, the other readings are invalid.
  if (phase == 1) {
    watch_reference(servo, input->analog[KZ_ANALOG_REFERENCE]);
  } else if (phase == 2) {
    watch_supply(servo, input->analog[KZ_ANALOG_SUPPLY]);
  } else {
    watch_temperature(servo, input->analog[KZ_ANALOG_TEMPERATURE]);
  }
}

u8 kz_health_active_fault(const kz_servo* servo) {
  if (servo->reference_bad_ms != 0) return KZ_SHUTDOWN_REFERENCE;
  if (servo->supply_bad_ms != 0) return supply_reason(servo);
  if (servo->hot_ms != 0) return KZ_SHUTDOWN_TEMPERATURE;
  return KZ_SHUTDOWN_NONE;
}
