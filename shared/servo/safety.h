// What switches the motors off without being asked.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SAFETY_H
#define KAZ_SHARED_SERVO_SAFETY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// The one way in which motors go off unasked: all of them, latched with a KZ_SHUTDOWN_* reason and the
// joint that caused it (KZ_NO_DETAIL if none did). The first reason stays.
void kz_shutdown(kz_servo* servo, u8 reason, u8 detail);

// One millisecond of the link watchdog, the supply and the missed ticks. Before the joints.
void kz_safety_update(kz_servo* servo, const kz_tick_input* input);

u16 kz_status(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
