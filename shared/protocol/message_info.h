// Names, codes and fields of all messages as data: for hosts that print, log, fuzz or dissect.
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
  const char* mask;  // field that says which elements are present; NULL: all
  long long low;     // a request with a number below it is refused; the lowest of the type if not
  long long high;    // the same above
  u8 size;           // bytes of one number
  u8 count;          // numbers, at most
  u8 bounded;        // 1: the table gives bounds
} kz_field_info;

typedef struct kz_message_info {
  const char* name;
  const char* text;
  const kz_field_info* fields;
  u8 field_count;
  u8 code;
  u8 kind;      // KZ_KIND_*
  u8 size_max;  // bytes of fields, at most
} kz_message_info;

extern const kz_message_info kz_messages[];
extern const u8 kz_message_count;

// NULL if no message has this code.
const kz_message_info* kz_message_find(u8 code);

// KZ_KIND_* of the message with this code; KZ_KIND_NONE if there is none.
u8 kz_kind_of(u8 code);
// Whether a request changes nothing, so that it does not matter how often and when it is done.
u8 kz_is_query(u8 request);
// Whether the board writes flash for a request: its reply takes up to 3 s.
u8 kz_writes_flash(u8 request);
// Whether the board receives nothing for a while after a request: it writes flash or restarts.
u8 kz_interrupts_service(u8 request);

// "out of range" for KZ_REFUSED_RANGE; never NULL.
const char* kz_refusal_text(u8 reason);
// "emergency stop" for KZ_SHUTDOWN_STOP; never NULL.
const char* kz_shutdown_text(u8 reason);
// "HOLDING" for KZ_STATUS_HOLDING: name of the flag with this one bit; NULL if there is
// none.
const char* kz_status_name(u16 flag);

#ifdef __cplusplus
}
#endif

#endif
