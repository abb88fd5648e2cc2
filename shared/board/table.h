// Joint table for the servo loop: calibration, limits and A/D input of each joint. Generated at compile time
// from joints.def and the limits of the URDF.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_TABLE_H
#define KAZ_SHARED_BOARD_TABLE_H

#include "shared/base/types.h"
#include "shared/board/board.h"

#ifdef __cplusplus
extern "C" {
#endif

// Half the range of a potentiometer: 95 degrees, in units of 100 urad.
#define KZ_POT_HALF_SPAN 16581

typedef struct kz_board_joint {
  s16 pot_centre;  // joint angle at code 512, in units of 100 urad (kz_pot_angle)
  s16 pot_scale;   // change of joint angle over 512 codes: KZ_POT_HALF_SPAN or -KZ_POT_HALF_SPAN
  s16 lower;       // mechanical limits (URDF), in units of 100 urad
  s16 upper;
  u8 analog;    // index into kz_tick_input.analog
  u8 mirrored;  // 1: the joint angle decreases when the shaft turns forward
} kz_board_joint;

extern const kz_board_joint kz_board_joints[KZ_JOINTS];

// Returns the joint angle at potentiometer code `code` (0..1023) with the nominal calibration, in units of
// 100 urad. Each code covers a range of 190/1024 degrees, and the function returns the middle of this range.
// The range of code 512 starts at the angle in joints.def; kz_board_joint::pot_centre is the middle of this
// range. With the start of the range instead of the middle, two mirrored servos would err in opposite
// directions. The robot would then walk in a curve.
s16 kz_pot_angle(const kz_board_joint* joint, u16 code);

#ifdef __cplusplus
}
#endif

#endif
