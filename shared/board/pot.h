// From a potentiometer's code to the joint's angle; inline, as the servo loop does it for every joint.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_POT_H
#define KAZ_SHARED_BOARD_POT_H

#include "shared/board/table.h"

// Joint angle at code 0, from the last two columns of joints.def.
#define KZ_POT_BASE(sign, pot_centre) \
  ((s16)(KZ_DECIDEG(pot_centre) - ((sign) > 0 ? KZ_POT_SPAN / 2 : -(KZ_POT_SPAN / 2))))

// See kz_pot_angle. The product of a code, taken as a share of 2^16, and the span has the angle in its
// upper half: one multiplication, no shift.
static inline s16 kz_pot_angle_from(u16 code, s16 base, u8 mirrored) {
  const u16 share = (u16)(code << 6);
  const u16 turned = (u16)((u32)share * (u16)KZ_POT_SPAN >> 16);
  return (s16)(mirrored ? (u16)((u16)base - turned) : (u16)((u16)base + turned));
}

#endif
