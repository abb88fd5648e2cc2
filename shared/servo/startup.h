// Initializes struct kz_startup: sets the factory values, and tests the first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STARTUP_H
#define KAZ_SHARED_SERVO_STARTUP_H

#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets the factory values: nominal calibration and default address. Marks all tests as not done.
void kz_startup_nominal(kz_startup* startup);

// Tests the A/D code of the reference voltage, and records the result in `startup`. The test of the motor
// supply always passes: the board also runs without motor supply, but then the motors stay off. `analog` has
// the layout of kz_tick_input.analog.
void kz_startup_test_analog(kz_startup* startup, const u16* analog);

#ifdef __cplusplus
}
#endif

#endif
