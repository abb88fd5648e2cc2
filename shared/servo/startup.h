// State of the board before its first tick: factory values, and tests of the first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STARTUP_H
#define KAZ_SHARED_SERVO_STARTUP_H

#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

// A board as it comes from the factory: nominal calibration, default address, tests passed.
void kz_startup_nominal(kz_startup* startup);

// Tests of the converter by its reference, and of the supply (which is not said to have failed:
// without motor supply the board runs, motors off). `analog` as in kz_tick_input.
void kz_startup_test_analog(kz_startup* startup, const u16* analog);

#ifdef __cplusplus
}
#endif

#endif
