// Uses an installed Kaz from outside: one call into each of several libraries.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "host/robot/posture.h"
#include "shared/protocol/frame.h"
#include "sim/h8s/chip/chip.h"
#include "vision/color/ball.h"

int main() {
  const std::array<std::uint8_t, 3> body{1, 5, 0};
  std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
  const int length = kz_frame_encode(body.data(), body.size(), wire.data());
  kaz::h8s::Chip chip;
  chip.power_on();
  kaz::vision::BallDetector detector{kaz::vision::BallOptions{}};
  std::printf("%d bytes, first joint %s\n", length, kaz::host::joint_table()[0].name);
  return length == 9 ? 0 : 1;
}
