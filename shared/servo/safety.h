// What switches the motors off without being asked.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SAFETY_H
#define KAZ_SHARED_SERVO_SAFETY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// The one way in which motors go off unasked: all of them, latched with a KZ_SHUTDOWN_* reason and
// the joint that caused it (KZ_NO_DETAIL if none did). The first reason stays.
void kz_shutdown(kz_servo* servo, u8 reason, u8 detail);

// One millisecond of the link watchdog and the missed ticks. Before the joints, as kz_health_update.
void kz_safety_update(kz_servo* servo, const kz_tick_input* input);

// KZ_SHUTDOWN_* of something that is not sound at present and would switch motors off sooner or
// later: the board, or the potentiometer of a joint of the mask. KZ_SHUTDOWN_NONE if all is well.
u8 kz_active_fault(const kz_servo* servo, u32 mask);
// Whether the cause of the latched shutdown is still there.
u8 kz_cause_present(const kz_servo* servo);

u8 kz_motors_on(const kz_servo* servo);
u16 kz_status(const kz_servo* servo);

// Supply, temperature of the drivers, reference of the converter: measured, and watched while motors
// are on (health.c).
void kz_health_init(kz_servo* servo);
// Where servo->phase & 3 is not 0.
void kz_health_update(kz_servo* servo, const kz_tick_input* input);
// KZ_SHUTDOWN_* of what is out of its range at present.
u8 kz_health_active_fault(const kz_servo* servo);

// A counter that stays at its highest value.
static inline void kz_count(u16* counter) {
  if (*counter < 0xFFFF) ++*counter;
}

#ifdef __cplusplus
}
#endif

#endif
