// Factory values, and tests of the first A/D codes.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/startup.h"

#include "shared/board/table.h"
#include "shared/protocol/messages.h"
#include "shared/servo/servo.h"

void kz_startup_nominal(kz_startup* startup) {
  u8 i;
  startup->image_crc = 0;
  startup->start_8states = 0;
  startup->reset_cause = KZ_RESET_POWER;
  startup->tests_done = 0;
  startup->tests_failed = 0;
  startup->address = KZ_ADDRESS_DEFAULT;
  startup->shared_line = 0;
  startup->calibration = KZ_CALIBRATION_NOMINAL;
  for (i = 0; i < KZ_JOINTS; ++i) {
    startup->pot_centre[i] = kz_board_joints[i].pot_centre;
    startup->pot_scale[i] = kz_board_joints[i].pot_scale;
  }
}

void kz_startup_test_analog(kz_startup* startup, const u16* analog) {
  const u16 code = analog[KZ_ANALOG_REFERENCE];
  startup->tests_done |= KZ_TEST_CONVERTER | KZ_TEST_SUPPLY;
  if (code < KZ_REFERENCE_CODE - KZ_REFERENCE_TOLERANCE ||
      code > KZ_REFERENCE_CODE + KZ_REFERENCE_TOLERANCE) {
    startup->tests_failed |= KZ_TEST_CONVERTER;
  }
}
