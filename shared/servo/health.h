// Supply, temperature of the motor drivers, reference of the converter.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_HEALTH_H
#define KAZ_SHARED_SERVO_HEALTH_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Supply, temperature of the drivers, reference of the converter: measured, and watched while motors
// are on (health.c).
void kz_health_init(kz_servo* servo);
// Where servo->phase & 3 is not 0.
void kz_health_update(kz_servo* servo, const kz_tick_input* input);
// KZ_SHUTDOWN_* of what is out of its range at present.
u8 kz_health_active_fault(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
