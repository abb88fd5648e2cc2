// Supply, temperature of the motor drivers, reference of the converter.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/commands.h"
#include "shared/servo/safety.h"

#define SUPPLY_MV_PER_CODE (KZ_SUPPLY_FULL_MV / KZ_POT_CODES)

void kz_health_init(kz_servo* servo) {
  servo->supply_lowest_mv = 0xFFFF;
}

// Counts for how long something has been bad, up to `limit`; returns 1 when it has been for so long.
static u8 bad_for(u8* counter, u8 bad, u8 limit) {
  if (!bad) {
    *counter = 0;
    return 0;
  }
  if (*counter < limit) ++*counter;
  return (u8)(*counter == limit);
}

static u8 supply_reason(const kz_servo* servo) {
  return servo->supply_mv < KZ_SUPPLY_LOWEST_MV ? KZ_SHUTDOWN_UNDERVOLTAGE
                                                : KZ_SHUTDOWN_OVERVOLTAGE;
}

void kz_health_update(kz_servo* servo, const kz_tick_input* input) {
  const u16 supply_mv = (u16)(input->analog[KZ_ANALOG_SUPPLY] * SUPPLY_MV_PER_CODE);
  const u16 reference = input->analog[KZ_ANALOG_REFERENCE];
  // Full scale of the temperature is as many tenths of a degree as there are codes.
  const s16 temperature = (s16)input->analog[KZ_ANALOG_TEMPERATURE];
  u8 reason = KZ_SHUTDOWN_NONE;
  servo->supply_mv = supply_mv;
  servo->reference = reference;
  servo->temperature_dc = temperature;
  if (supply_mv < servo->supply_lowest_mv) servo->supply_lowest_mv = supply_mv;
  if (bad_for(&servo->hot_ms, (u8)(temperature > KZ_TEMPERATURE_HIGHEST_DC),
              KZ_TEMPERATURE_FAULT_MS)) {
    reason = KZ_SHUTDOWN_TEMPERATURE;
  }
  if (bad_for(&servo->supply_bad_ms,
              (u8)(supply_mv < KZ_SUPPLY_LOWEST_MV || supply_mv > KZ_SUPPLY_HIGHEST_MV),
              KZ_SUPPLY_FAULT_MS)) {
    reason = supply_reason(servo);
  }
  // Last, so that it is the reason where it comes with others: what the others read means nothing.
  if (bad_for(&servo->reference_bad_ms,
              (u8)(reference < KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE ||
                   reference > KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE),
              KZ_REFERENCE_FAULT_MS)) {
    reason = KZ_SHUTDOWN_REFERENCE;
  }
  if (reason != KZ_SHUTDOWN_NONE && kz_motors_on(servo)) {
    kz_shutdown(servo, reason, KZ_NO_DETAIL);
  }
}

u8 kz_health_unsound(const kz_servo* servo) {
  if (servo->reference_bad_ms != 0) return KZ_SHUTDOWN_REFERENCE;
  if (servo->supply_bad_ms != 0) return supply_reason(servo);
  if (servo->hot_ms != 0) return KZ_SHUTDOWN_TEMPERATURE;
  return KZ_SHUTDOWN_NONE;
}
