// Encodes a whole frame at once, for those who have the room: hosts and tests.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/frame.h"

u8 kz_frame_encode(const u8* body, u8 body_length, u8* wire) {
  kz_sender sender;
  u8 i;
  kz_sender_init(&sender);
  for (i = 0; i < body_length && i < KZ_BODY_MAX; ++i) sender.body[i] = body[i];
  kz_sender_start(&sender, i);
  return kz_sender_take(&sender, wire, KZ_FRAME_MAX);
}
