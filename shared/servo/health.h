// Monitors the supply, the temperature of the motor drivers and the A/D reference.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_HEALTH_H
#define KAZ_SHARED_SERVO_HEALTH_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Marks supply, temperature and A/D reference as not measured yet. kz_health_active_fault reports a quantity
// that is not measured yet as a fault.
void kz_health_init(kz_servo* servo);
// Checks one of the three quantities. Shuts down if the quantity stays out of range while motors are on. Call
// kz_health_update in every tick with servo->phase & 3 != 0.
void kz_health_update(kz_servo* servo, const kz_tick_input* input);
// Returns the KZ_SHUTDOWN_* reason of a quantity that is out of range now, or KZ_SHUTDOWN_NONE.
u8 kz_health_active_fault(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
