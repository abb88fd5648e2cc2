// From a potentiometer's code to the joint's angle; inline for the servo loop.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_POT_H
#define KAZ_SHARED_BOARD_POT_H

#include "shared/board/table.h"

// Angle of 2^15 shares of a turn of the potentiometer: half its range, signed. A code is 64 shares.
#define KZ_POT_SCALE(sign) ((s16)((sign) > 0 ? KZ_POT_HALF_SPAN : -KZ_POT_HALF_SPAN))

// See kz_pot_angle. `code` counts as signed around mid-scale in shares of 2^15 of half the range;
// so one multiplication has the angle in its upper half, and no shift is left.
static inline s16 kz_pot_angle_from(u16 code, s16 centre, s16 scale) {
  const s16 share = (s16)((s16)(code - KZ_POT_CODES / 2) * 64);
  const s16 turned = (s16)((s32)share * scale * 2 >> 16);
  return (s16)(centre + turned);
}

#endif
