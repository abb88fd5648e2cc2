// From the state of the joints to the pins, as joints.def wires them.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/outputs.h"

#define PWM(channel) (*((channel) < 16 ? &output->pw[(channel)&15] : &output->tmo[(channel)&1]))

static void all_off(kz_tick_output* output) {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) PWM(pwm) = 0;
#include "shared/board/joints.def"
#undef KZ_JOINT
  output->p3 = 0;
  output->p4 = 0;
  output->p5 = 0;
  output->p6 = 0;
}

void kz_outputs_write(const kz_servo* servo, kz_tick_output* output) {
  const kz_joint* joint = servo->joint;
  u8 p3 = 0;
  u8 p4 = KZ_P4_ENABLE;
  u8 p5 = 0;
  u8 p6 = 0;
  if (servo->enabled == 0 && servo->raw_ms == 0) {
    all_off(output);
    return;
  }
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  PWM(pwm) = joint[index].duty;                                             \
  if (joint[index].forward) p##port |= (u8)(1 << (bit));
#include "shared/board/joints.def"
#undef KZ_JOINT
  output->p3 = p3;
  output->p4 = p4;
  output->p5 = p5;
  output->p6 = p6;
}
