// Codec of every message, made from messages.def.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/messages.h"

#include "shared/protocol/bytes.h"

// Fails to compile where a message does not fit a frame.
#define KZ_MESSAGE(name, code, kind, text) \
  typedef char name##_fits_a_frame[KZ_SIZE_##name <= KZ_PAYLOAD_MAX ? 1 : -1];
#include "shared/protocol/messages.def"

#define KZ_MESSAGE(name, code, kind, text)                         \
  u8 kz_pack_##name(const struct kz_##name* message, u8* fields) { \
    u8* to = fields;                                               \
    (void)message;
#define KZ_FIELD(type, name, unit, text) to = kz_put_##type(to, message->name);
#define KZ_ARRAY(type, name, count, unit, text)                             \
  {                                                                         \
    u8 i;                                                                   \
    for (i = 0; i < (count); ++i) to = kz_put_##type(to, message->name[i]); \
  }
#define KZ_MASKED(type, name, mask, most, unit, text) \
  {                                                   \
    u32 bits = message->mask;                         \
    u8 left = (most);                                 \
    u8 i;                                             \
    for (i = 0; i < KZ_JOINTS; ++i) {                 \
      if ((bits & 1) && left != 0) {                  \
        to = kz_put_##type(to, message->name[i]);     \
        --left;                                       \
      }                                               \
      bits >>= 1;                                     \
    }                                                 \
  }
#define KZ_END()            \
  return (u8)(to - fields); \
  }
#include "shared/protocol/messages.def"

#define TAKE(type, variable)               \
  if (length < (u8)sizeof(type)) return 0; \
  variable = kz_get_##type(fields);        \
  fields += sizeof(type);                  \
  length = (u8)(length - sizeof(type));

#define KZ_MESSAGE(name, code, kind, text)                                      \
  u8 kz_unpack_##name(struct kz_##name* message, const u8* fields, u8 length) { \
    (void)fields;
#define KZ_FIELD(type, name, unit, text) TAKE(type, message->name)
#define KZ_ARRAY(type, name, count, unit, text) \
  {                                             \
    u8 i;                                       \
    for (i = 0; i < (count); ++i) {             \
      TAKE(type, message->name[i])              \
    }                                           \
  }
#define KZ_MASKED(type, name, mask, most, unit, text) \
  {                                                   \
    u32 bits = message->mask;                         \
    u8 left = (most);                                 \
    u8 i;                                             \
    for (i = 0; i < KZ_JOINTS; ++i) {                 \
      message->name[i] = 0;                           \
      if ((bits & 1) && left != 0) {                  \
        TAKE(type, message->name[i])                  \
        --left;                                       \
      }                                               \
      bits >>= 1;                                     \
    }                                                 \
  }
#define KZ_NO_FIELDS() message->no_fields = 0;
#define KZ_END()            \
  return (u8)(length == 0); \
  }
#include "shared/protocol/messages.def"

// Functions, so that comparing with the end of a type's range is no mistake to a compiler.
static inline u8 outside_u8(u8 value, u8 low, u8 high) {
  return (u8)(value < low || value > high);
}
static inline u8 outside_u16(u16 value, u16 low, u16 high) {
  return (u8)(value < low || value > high);
}
static inline u8 outside_s16(s16 value, s16 low, s16 high) {
  return (u8)(value < low || value > high);
}
static inline u8 outside_u32(u32 value, u32 low, u32 high) {
  return (u8)(value < low || value > high);
}

#define KZ_MESSAGE(name, code, kind, text)              \
  u8 kz_check_##name(const struct kz_##name* message) { \
    u8 field = 0;                                       \
    (void)message;                                      \
    (void)field;
#define KZ_FIELD(type, name, unit, text) ++field;
#define KZ_BOUNDED(type, name, low, high, unit, text)             \
  if (outside_##type(message->name, (low), (high))) return field; \
  ++field;
#define KZ_ARRAY(type, name, count, unit, text) ++field;
#define KZ_MASKED(type, name, mask, most, unit, text) ++field;
#define KZ_END()       \
  return KZ_IN_BOUNDS; \
  }
#include "shared/protocol/messages.def"
