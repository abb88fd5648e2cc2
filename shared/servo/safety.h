// Link watchdog, missed ticks and active faults: conditions that switch the motors off without a request.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SAFETY_H
#define KAZ_SHARED_SERVO_SAFETY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Advances the link watchdog and counts missed ticks. Call this function in every tick, before
// kz_joints_update.
void kz_safety_update(kz_servo* servo, const kz_tick_input* input);

// Returns the KZ_SHUTDOWN_* reason of a fault that is present now. If there is no fault, returns
// KZ_SHUTDOWN_NONE. Checks the board's health and the potentiometers of the joints in the mask.
u8 kz_active_fault(const kz_servo* servo, u32 mask);
// Returns nonzero if the cause of the latched shutdown is still present.
u8 kz_cause_present(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
