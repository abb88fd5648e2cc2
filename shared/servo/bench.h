// Requests for the bench: unlock, raw drive, flash, reset.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_BENCH_H
#define KAZ_SHARED_SERVO_BENCH_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// One millisecond of the times of unlock and raw drive. To be called while unlocked_ms is not 0:
// without it there is no raw drive.
void kz_bench_update(kz_servo* servo, const kz_tick_input* input);

// Drives the motor of the raw drive, after the joints' loops; raw_ms is not 0.
void kz_bench_drive(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
