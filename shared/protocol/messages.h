// Messages as C structs, and their codec, made from messages.def.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_PROTOCOL_MESSAGES_H
#define KAZ_SHARED_PROTOCOL_MESSAGES_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_PROTOCOL_VERSION 1
#define KZ_REPLY 0x80         // bit of the type: from board to host
#define KZ_ADDRESS_DEFAULT 1  // a board whose id block is empty
#define KZ_ADDRESS_ALL 15

// Status flags.
#define KZ_STATUS_ENABLED 0x0001        // at least one motor is on
#define KZ_STATUS_MOVING 0x0002         // at least one ramp is still under way
#define KZ_STATUS_LINK_WATCHDOG 0x0100  // latched: motors went off because the host was silent
#define KZ_STATUS_MISSED_TICK 0x0200    // latched: a tick took too long
#define KZ_STATUS_POT_FAULT 0x0400     // latched: a potentiometer is open or short, motors went off
#define KZ_STATUS_SUPPLY_FAULT 0x0800  // latched: motor supply out of range, motors went off
// The latched ones: an enable message with a non-empty mask clears them if their cause is gone.
#define KZ_STATUS_FAULTS 0xFF00

// Reasons of a refusal.
#define KZ_REFUSED_UNKNOWN_TYPE 1  // no request has this type
#define KZ_REFUSED_LENGTH 2        // more or fewer bytes than the type's fields
#define KZ_REFUSED_RANGE 3         // a value out of its range; detail: joint number or field
#define KZ_REFUSED_LIMIT 4         // a target outside the joint's limits; detail: joint number
#define KZ_REFUSED_DISABLED 5      // a target for a joint that is off; detail: joint number
#define KZ_REFUSED_FAULT 6         // a fault is present that must go away first
#define KZ_REFUSED_BUSY 7          // the previous reply is still being sent

// Codes: KZ_TYPE_<name>.
enum kz_type {
#define KZ_MESSAGE(name, code, text) KZ_TYPE_##name = code,
#include "shared/protocol/messages.def"
};

// Bytes of fields at most: KZ_SIZE_<name>.
enum kz_size {
#define KZ_MESSAGE(name, code, text) KZ_SIZE_##name = 0
#define KZ_FIELD(type, name, unit, text) +(int)sizeof(type)
#define KZ_ARRAY(type, name, count, unit, text) +(count) * (int)sizeof(type)
#define KZ_MASKED(type, name, mask, unit, text) +KZ_JOINTS*(int)sizeof(type)
#define KZ_END() ,
#include "shared/protocol/messages.def"
};

// struct kz_<name> for each message. One without fields has a dummy member, always 0.
#define KZ_MESSAGE(name, code, text)  \
  typedef struct kz_##name kz_##name; \
  struct kz_##name {
#define KZ_FIELD(type, name, unit, text) type name;
#define KZ_ARRAY(type, name, count, unit, text) type name[count];
#define KZ_MASKED(type, name, mask, unit, text) type name[KZ_JOINTS];
#define KZ_NO_FIELDS() u8 no_fields;
#define KZ_END() \
  }              \
  ;
#include "shared/protocol/messages.def"

// kz_pack_<name> writes the bytes behind the header and returns how many (at most KZ_SIZE_<name>).
// kz_unpack_<name> returns 1 if the length is right for the message, else 0. Bits of a mask above
// the highest joint stand for no number; numbers of joints outside the mask become 0.
#define KZ_MESSAGE(name, code, text)                              \
  u8 kz_pack_##name(const struct kz_##name* message, u8* fields); \
  u8 kz_unpack_##name(struct kz_##name* message, const u8* fields, u8 length);
#include "shared/protocol/messages.def"

#ifdef __cplusplus
}
#endif

#endif
