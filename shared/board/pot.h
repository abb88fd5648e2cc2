// From a potentiometer's code to the joint's angle; inline, as the servo loop does it for every
// joint. SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_POT_H
#define KAZ_SHARED_BOARD_POT_H

#include "shared/board/table.h"

// See kz_pot_angle. The product of a code, taken as a share of 2^16, and the span has the angle in
// its upper half: one multiplication, no shift.
static inline s16 kz_pot_angle_of(const kz_board_joint* joint, u16 code) {
  const u16 share = (u16)(code << 6);
  const u16 turned = (u16)((u32)share * (u16)KZ_POT_SPAN >> 16);
  const u16 base = (u16)joint->pot_base;
  return (s16)(joint->mirrored ? (u16)(base - turned) : (u16)(base + turned));
}

#endif
