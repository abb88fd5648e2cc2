// The servo tick: the computation that the board performs every millisecond. Its only inputs are snapshot and
// state.
// SPDX-License-Identifier: Apache-2.0
//
// Equal sequences of kz_tick_input give equal sequences of kz_tick_output and equal state, on the H8S/2128
// and on the PC. Therefore the tick reads no register, no clock, and no memory except its own state. All
// measurements, such as the length of the last tick or the CRC of the image, enter through the snapshot or
// kz_startup.
#ifndef KAZ_SHARED_SERVO_TICK_H
#define KAZ_SHARED_SERVO_TICK_H

#include "shared/servo/servo.h"
#include "shared/servo/snapshot.h"
#include "shared/servo/startup.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets `servo` to its state after reset, with motors off, and `output` to zeros. Latches
// KZ_SHUTDOWN_SELF_TEST if a test in `startup` failed.
void kz_servo_init(kz_servo* servo, const kz_startup* startup, kz_tick_output* output);

// Runs one tick. On entry, `output` must contain the output of the previous tick or of kz_servo_init; kz_tick
// replaces all of `output`. After the start and after a shutdown, all motors are off: enable bit and duties
// are 0. They stay off until a request enables a joint or starts a raw drive.
void kz_tick(kz_servo* servo, const kz_tick_input* input, kz_tick_output* output);

#ifdef __cplusplus
}
#endif

#endif
