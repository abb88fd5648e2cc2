// Bench functions of the servo tick. kz_bench_drive drives one motor directly (raw drive). The raw drive and
// the bench unlock have time limits, and kz_bench_update ends the raw drive and the unlock at these limits.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_BENCH_H
#define KAZ_SHARED_SERVO_BENCH_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Reduces the remaining times of the unlock and of the raw drive: by 1 ms for this tick and for each missed
// tick. Call kz_bench_update in every tick while unlocked_ms is not 0. A raw drive requires the unlock.
void kz_bench_update(kz_servo* servo, const kz_tick_input* input);

// Sets duty and direction of the raw-driven motor. Shuts down if the potentiometer of the raw-driven joint
// stays out of range. While raw_ms is not 0, call kz_bench_drive in every tick after kz_joints_update.
void kz_bench_drive(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
