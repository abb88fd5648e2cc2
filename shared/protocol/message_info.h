// Reflection of all messages: names, codes and fields, for hosts that print, log, fuzz or dissect messages.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_PROTOCOL_MESSAGE_INFO_H
#define KAZ_SHARED_PROTOCOL_MESSAGE_INFO_H

#include "shared/protocol/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct kz_field_info {
  const char* type;  // "u8", "u16", "s16", "u32"
  const char* name;
  const char* unit;
  const char* text;
  // Name of the field that contains the mask, or NULL if there is no mask. If there is a mask, the message
  // contains only the elements whose bits in the mask are set.
  const char* mask;
  // Bounds of a field in a request. If messages.def gives no bounds, these are the lowest and the highest
  // value of the type.
  long long low;
  long long high;
  u8 size;     // bytes of one number
  u8 count;    // maximum number of elements
  u8 bounded;  // 1: messages.def gives bounds for the field
} kz_field_info;

typedef struct kz_message_info {
  const char* name;
  const char* text;
  const kz_field_info* fields;
  u8 field_count;
  u8 code;
  u8 kind;      // KZ_KIND_*
  u8 size_max;  // maximum size of the fields, bytes
} kz_message_info;

extern const kz_message_info kz_messages[];
extern const u8 kz_message_count;

// Returns the message with this code, or NULL.
const kz_message_info* kz_message_find(u8 code);

// Returns the KZ_KIND_* of the message with this code, or KZ_KIND_NONE.
u8 kz_kind_of(u8 code);
// Returns 1 if a request changes nothing and can be repeated at any time.
u8 kz_is_query(u8 request);
// Returns 1 if the board writes flash to execute a request. The reply to such a request takes up to 3 s.
u8 kz_writes_flash(u8 request);
// Returns 1 if the board writes flash or restarts to execute a request. During this time, the board receives
// nothing.
u8 kz_interrupts_service(u8 request);

// Returns the text of a refusal, such as "value out of range" for KZ_REFUSED_RANGE. Never NULL.
const char* kz_refusal_text(u8 reason);
// Returns the text of a shutdown, such as "emergency stop" for KZ_SHUTDOWN_STOP. Never NULL.
const char* kz_shutdown_text(u8 reason);
// Returns the name of a status flag (a single bit), such as "HOLDING" for KZ_STATUS_HOLDING. Returns NULL if
// the flag is unknown.
const char* kz_status_name(u16 flag);

#ifdef __cplusplus
}
#endif

#endif
