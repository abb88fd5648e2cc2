// Converts a potentiometer's A/D code to a joint angle. The function is inline, because the servo loop calls
// it often.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_POT_H
#define KAZ_SHARED_BOARD_POT_H

#include "shared/board/table.h"

// Change of the joint angle over half the potentiometer's range, in units of 100 urad; negative if `sign` is
// negative. Use KZ_POT_SCALE for the argument `scale` of kz_pot_angle_from.
#define KZ_POT_SCALE(sign) ((s16)((sign) > 0 ? KZ_POT_HALF_SPAN : -KZ_POT_HALF_SPAN))

// Returns the joint angle at A/D code `code` (0..1023), in units of 100 urad. `centre` and `scale` are
// pot_centre and pot_scale of the joint. The result is `centre` + `turned`. The variable `turned` is the
// change of the angle from code 512 to `code`. `turned` is the upper 16 bits of a 32-bit product, so the H8
// needs no shift loop. The product is: (code - 512) * 64 * scale * 2.
static inline s16 kz_pot_angle_from(u16 code, s16 centre, s16 scale) {
  const s16 share = (s16)((s16)(code - KZ_POT_CODES / 2) * 64);
  const s16 turned = (s16)((s32)share * scale * 2 >> 16);
  return (s16)(centre + turned);
}

#endif
