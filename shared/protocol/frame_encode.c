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

u8 kz_frame_splits(const u8* wire, u8 length) {
  u16 crc = 0xFFFF;
  u8 i;
  for (i = 1; i + 4 < length; ++i) {
    crc = kz_crc16(crc, wire[i]);
    if (crc == 0xFFFF) return 1;
  }
  return 0;
}
