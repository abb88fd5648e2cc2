// The joint table as data: what the servo loop needs of joints.def and of the joints' limits.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_TABLE_H
#define KAZ_SHARED_BOARD_TABLE_H

#include "shared/base/types.h"
#include "shared/board/board.h"

#ifdef __cplusplus
extern "C" {
#endif

// Half the range of a potentiometer, 95 degrees, in 100 urad.
#define KZ_POT_HALF_SPAN 16581

typedef struct kz_board_joint {
  s16 pot_centre;  // joint angle at code 512, 100 urad
  s16 pot_scale;   // +-KZ_POT_HALF_SPAN: angle of half the range of codes
  s16 lower;       // limits of the joint (URDF), 100 urad
  s16 upper;
  u8 analog;    // index into kz_tick_input.analog
  u8 mirrored;  // 1: a forward shaft is a negative joint angle
} kz_board_joint;

extern const kz_board_joint kz_board_joints[KZ_JOINTS];

// Joint angle in 100 urad at a potentiometer's code 0..1023: code 512 is the centre of joints.def,
// one code is 190/1024 degrees.
s16 kz_pot_angle(const kz_board_joint* joint, u16 code);

#ifdef __cplusplus
}
#endif

#endif
