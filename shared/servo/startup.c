// What the board finds out at its start from its first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/startup.h"

#include "shared/protocol/messages.h"

#define REFERENCE_NOMINAL (KZ_POT_CODES / 2)
#define REFERENCE_TOLERANCE 16  // codes: 3 %

void kz_startup_test_analog(kz_startup* startup, const u16* analog) {
  const u16 code = analog[KZ_ANALOG_REFERENCE];
  startup->tests_done |= KZ_TEST_CONVERTER | KZ_TEST_SUPPLY;
  if (code < REFERENCE_NOMINAL - REFERENCE_TOLERANCE ||
      code > REFERENCE_NOMINAL + REFERENCE_TOLERANCE) {
    startup->tests_failed |= KZ_TEST_CONVERTER;
  }
}
