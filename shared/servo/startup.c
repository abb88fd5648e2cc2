// What the board finds out at its start from its first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/startup.h"

#include "shared/protocol/messages.h"
#include "shared/servo/servo.h"

void kz_startup_test_analog(kz_startup* startup, const u16* analog) {
  const u16 code = analog[KZ_ANALOG_REFERENCE];
  startup->tests_done |= KZ_TEST_CONVERTER | KZ_TEST_SUPPLY;
  if (code < KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE ||
      code > KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE) {
    startup->tests_failed |= KZ_TEST_CONVERTER;
  }
}
