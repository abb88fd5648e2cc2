// Monitors the supply, the temperature of the motor drivers and the A/D reference.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_HEALTH_H
#define KAZ_SHARED_SERVO_HEALTH_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Initializes supply, temperature and A/D reference. Until all three quantities have been measured,
// kz_health_active_fault reports a fault.
void kz_health_init(kz_servo* servo);
// Checks the supply, the temperature or the A/D reference; servo->phase selects the quantity. Shuts down if
// the quantity stays out of range while motors are on. Call kz_health_update in every tick in which
// servo->phase is not a multiple of 4.
void kz_health_update(kz_servo* servo, const kz_tick_input* input);
// Returns the KZ_SHUTDOWN_* reason of a quantity that is out of range now, or KZ_SHUTDOWN_NONE.
u8 kz_health_active_fault(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
