// What the board finds out at its start from its first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STARTUP_H
#define KAZ_SHARED_SERVO_STARTUP_H

#include "shared/servo/tick.h"

#ifdef __cplusplus
extern "C" {
#endif

// Tests of the converter by its reference, and of the supply (which is not said to have failed:
// without motor supply the board runs, motors off). `analog` as in kz_tick_input.
void kz_startup_test_analog(kz_startup* startup, const u16* analog);

#ifdef __cplusplus
}
#endif

#endif
