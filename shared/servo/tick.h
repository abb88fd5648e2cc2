// The servo tick: all that the board computes each millisecond, from snapshot and state alone.
// SPDX-License-Identifier: Apache-2.0
//
// Equal sequences of kz_tick_input give equal sequences of kz_tick_output and equal state, on the
// H8S/2128 and on the PC (design, section 3). So nothing here reads a register, a clock or memory
// it does not own: whatever is measured (how long the last tick took, the CRC of the image) comes
// in through the snapshot.
#ifndef KAZ_SHARED_SERVO_TICK_H
#define KAZ_SHARED_SERVO_TICK_H

#include "shared/servo/servo.h"
#include "shared/servo/snapshot.h"
#include "shared/servo/startup.h"

#ifdef __cplusplus
extern "C" {
#endif

// Brings the state to that after reset: motors off, nothing received. Writes the outputs for it.
void kz_servo_init(kz_servo* servo, const kz_startup* startup, kz_tick_output* output);

// One tick. `output` is that of the tick before, or all zeros, and is written whole. Motors are off
// (enable bit 0, all duties 0) until the host enables a joint, and again after any fault.
void kz_tick(kz_servo* servo, const kz_tick_input* input, kz_tick_output* output);

#ifdef __cplusplus
}
#endif

#endif
