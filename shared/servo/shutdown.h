// Switching all motors off, and the latched reason for it.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SHUTDOWN_H
#define KAZ_SHARED_SERVO_SHUTDOWN_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Switches all motors off and latches a KZ_SHUTDOWN_* reason with the joint that caused it (KZ_NO_DETAIL
// if none did). Only the first reason is kept.
void kz_shutdown(kz_servo* servo, u8 reason, u8 detail);

// Latches reason and joint without switching anything off, unless a reason is latched already.
void kz_latch_shutdown(kz_servo* servo, u8 reason, u8 detail);

u8 kz_motors_on(const kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
