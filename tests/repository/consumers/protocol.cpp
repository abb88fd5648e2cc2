// A frame of the protocol, coded and decoded.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <cstdio>

#include "shared/protocol/frame.h"

int main() {
  const std::array<std::uint8_t, 3> body{1, 5, 0};
  std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
  const int length = kz_frame_encode(body.data(), body.size(), wire.data());
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  int frames = 0;
  for (int i = 0; i < length; ++i)
    frames += kz_receive(&receiver, wire[static_cast<std::size_t>(i)], 0) == KZ_RECEIVE_FRAME;
  std::printf("%d bytes, %d frame\n", length, frames);
  return length == 9 && frames == 1 ? 0 : 1;
}
