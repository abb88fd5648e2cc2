// Initializes struct kz_startup: sets the factory values, and tests the first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STARTUP_H
#define KAZ_SHARED_SERVO_STARTUP_H

#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets factory values: nominal calibration, default address, no tests done.
void kz_startup_nominal(kz_startup* startup);

// Tests the A/D converter (by its reference) and the motor supply, and records the results in `startup`. The
// test of the supply never fails, because the board also runs without motor supply, with motors off. `analog`
// has the layout of kz_tick_input.analog.
void kz_startup_test_analog(kz_startup* startup, const u16* analog);

#ifdef __cplusplus
}
#endif

#endif
