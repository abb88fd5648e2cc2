// Switches all motors off and latches the reason.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SHUTDOWN_H
#define KAZ_SHARED_SERVO_SHUTDOWN_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Switches all motors off and latches `reason` (KZ_SHUTDOWN_*) unless a reason is latched already. `detail`
// is the joint that caused the shutdown, or KZ_NO_DETAIL.
void kz_shutdown(kz_servo* servo, u8 reason, u8 detail);

// Latches reason and detail like kz_shutdown, but switches nothing off.
void kz_latch_shutdown(kz_servo* servo, u8 reason, u8 detail);

// Returns 1 while a joint is on or a raw drive runs.
u8 kz_motors_on(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
