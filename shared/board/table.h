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
  s16 pot_centre;  // joint angle that stands for code 512, 100 urad (kz_pot_angle)
  s16 pot_scale;   // +-KZ_POT_HALF_SPAN: angle of half the range of codes
  s16 lower;       // limits of the joint (URDF), 100 urad
  s16 upper;
  u8 analog;    // index into kz_tick_input.analog
  u8 mirrored;  // 1: a forward shaft is a negative joint angle
} kz_board_joint;

extern const kz_board_joint kz_board_joints[KZ_JOINTS];

// Joint angle in 100 urad at a potentiometer's code 0..1023, of which one is 190/1024 degrees. The
// converter rounds down, so a code stands for the middle of what it is made of: that of 512 begins
// at the centre of joints.def, and kz_board_joints[].pot_centre is half a code beyond it. Without
// that, each of two mirrored servos is off by half a code to its own side, and the robot curves.
s16 kz_pot_angle(const kz_board_joint* joint, u16 code);

#ifdef __cplusplus
}
#endif

#endif
