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
#define KZ_REPLY 0x80           // bit of the type: from board to host
#define KZ_ADDRESS_DEFAULT 1    // a board whose id block is empty
#define KZ_ADDRESS_ALL 15

// Status flags.
#define KZ_STATUS_ENABLED 0x0001        // at least one motor is on
#define KZ_STATUS_MOVING 0x0002         // at least one ramp is still under way
#define KZ_STATUS_LINK_WATCHDOG 0x0100  // latched: motors went off because the host was silent
#define KZ_STATUS_MISSED_TICK 0x0200    // latched: a tick took too long
#define KZ_STATUS_POT_FAULT 0x0400      // latched: a potentiometer is open or short, motors went off
#define KZ_STATUS_SUPPLY_FAULT 0x0800   // latched: motor supply out of range, motors went off
#define KZ_STATUS_FAULTS 0xFF00         // an enable message with a non-empty mask clears these if the cause is gone

// Reasons of a refusal.
#define KZ_REFUSED_UNKNOWN_TYPE 1
#define KZ_REFUSED_LENGTH 2
#define KZ_REFUSED_RANGE 3     // a value out of its range; detail: joint number or field
#define KZ_REFUSED_LIMIT 4     // a target outside the joint's limits; detail: joint number
#define KZ_REFUSED_DISABLED 5  // a target for a joint that is off; detail: joint number
#define KZ_REFUSED_FAULT 6     // a fault is present that must go away first
#define KZ_REFUSED_BUSY 7      // the previous reply is still being sent

// struct kz_<name> for each message, and
//   u8 kz_pack_<name>(const struct kz_<name> *, u8 *fields);        returns the length
//   u8 kz_unpack_<name>(struct kz_<name> *, const u8 *fields, u8 length);  1 if the length is right
// with `fields` the bytes behind the header.
// (the macro expansion stands here)

#ifdef __cplusplus
}
#endif

#endif
