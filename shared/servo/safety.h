// Link watchdog, missed ticks, active faults: what switches the motors off without a request.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SAFETY_H
#define KAZ_SHARED_SERVO_SAFETY_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// One millisecond of the link watchdog and the missed ticks. Before the joints, as kz_health_update.
void kz_safety_update(kz_servo* servo, const kz_tick_input* input);

// KZ_SHUTDOWN_* of a fault that is present and would switch motors off sooner or later: of the board, or
// of the potentiometer of a joint of the mask. KZ_SHUTDOWN_NONE if there is none.
u8 kz_active_fault(const kz_servo* servo, u32 mask);
// Whether the cause of the latched shutdown is still there.
u8 kz_cause_present(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
