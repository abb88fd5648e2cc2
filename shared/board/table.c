// The joint table as data.
// SPDX-License-Identifier: Apache-2.0
#include "shared/board/table.h"

#include "kz_limits.h"
#include "shared/board/pot.h"

const kz_board_joint kz_board_joints[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  [index] = {KZ_POT_CENTRE(pot_centre, sign), KZ_POT_SCALE(sign),           \
             KZ_LIMIT_LOWER_##name,           KZ_LIMIT_UPPER_##name,        \
             (mux)*KZ_MUX_INPUTS + (input),   (sign) < 0},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

s16 kz_pot_angle(const kz_board_joint* joint, u16 code) {
  return kz_pot_angle_from(code, joint->pot_centre, joint->pot_scale);
}
