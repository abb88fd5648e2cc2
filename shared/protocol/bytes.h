// Reads and writes big-endian numbers, for messages that are not packed by messages.h.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_PROTOCOL_BYTES_H
#define KAZ_SHARED_PROTOCOL_BYTES_H

#include "shared/base/types.h"

// kz_put_* return the address after the written bytes.
static inline u8* kz_put_u8(u8* to, u8 value) {
  to[0] = value;
  return to + 1;
}

static inline u8* kz_put_u16(u8* to, u16 value) {
  to[0] = (u8)(value >> 8);
  to[1] = (u8)value;
  return to + 2;
}

static inline u8* kz_put_s16(u8* to, s16 value) {
  return kz_put_u16(to, (u16)value);
}

static inline u8* kz_put_u32(u8* to, u32 value) {
  to = kz_put_u16(to, (u16)(value >> 16));
  return kz_put_u16(to, (u16)value);
}

static inline u8 kz_get_u8(const u8* from) {
  return from[0];
}
static inline u16 kz_get_u16(const u8* from) {
  return (u16)((u16)((u16)from[0] << 8) | from[1]);
}
static inline s16 kz_get_s16(const u8* from) {
  return (s16)kz_get_u16(from);
}
static inline u32 kz_get_u32(const u8* from) {
  return (u32)kz_get_u16(from) << 16 | kz_get_u16(from + 2);
}

#endif
