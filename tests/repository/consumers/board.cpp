// The firmware's tick on this machine: without a host the motors stay off.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "shared/servo/tick.h"

int main() {
  kz_startup startup;
  kz_startup_nominal(&startup);
  static kz_servo servo;
  static kz_tick_output output;
  kz_servo_init(&servo, &startup, &output);
  kz_tick_input input{};
  for (auto& code : input.analog) code = 512;
  for (int i = 0; i < 100; ++i, ++input.tick) kz_tick(&servo, &input, &output);
  std::printf("PW0 is high for %d of 256 counts\n", output.pw[0]);
  return output.pw[0] == 0 && (output.p4 & KZ_P4_ENABLE) == 0 ? 0 : 1;
}
