// Initializes struct kz_startup: factory values and self-tests of the first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_STARTUP_H
#define KAZ_SHARED_SERVO_STARTUP_H

#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets factory values: nominal calibration, default address, no tests done.
void kz_startup_nominal(kz_startup* startup);

// Records the tests of converter and supply. Only the converter can fail, by its reference: without motor
// supply the board runs with motors off. `analog` is as in kz_tick_input.
void kz_startup_test_analog(kz_startup* startup, const u16* analog);

#ifdef __cplusplus
}
#endif

#endif
