// What switches the motors off without being asked.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SAFETY_H
#define KAZ_SHARED_SERVO_SAFETY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// All motors off, because of `fault` (a latched KZ_STATUS_* flag).
void kz_safety_trip(kz_servo* servo, u16 fault);

// One millisecond of the link watchdog, the supply and the missed ticks. Before the joints.
void kz_safety_update(kz_servo* servo, const kz_tick_input* input);

u16 kz_status(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
