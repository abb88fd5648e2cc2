// The message table as data.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/message_info.h"

#include <stddef.h>

// Each table ends in an empty entry, so that a message without fields has a table too.
#define KZ_MESSAGE(name, code, text) static const kz_field_info fields_of_##name[] = {
#define KZ_FIELD(type, name, unit, text) {#type, #name, unit, text, NULL, sizeof(type), 1},
#define KZ_ARRAY(type, name, count, unit, text) \
  {#type, #name, unit, text, NULL, sizeof(type), count},
#define KZ_MASKED(type, name, mask, unit, text) \
  {#type, #name, unit, text, #mask, sizeof(type), KZ_JOINTS},
#define KZ_END()                         \
  { NULL, NULL, NULL, NULL, NULL, 0, 0 } \
  }                                      \
  ;
#include "shared/protocol/messages.def"

const kz_message_info kz_messages[] = {
#define KZ_MESSAGE(name, code, text)                                                             \
  {#name, text,          fields_of_##name, sizeof(fields_of_##name) / sizeof(kz_field_info) - 1, \
   code,  KZ_SIZE_##name},
#include "shared/protocol/messages.def"
};

const u8 kz_message_count = sizeof(kz_messages) / sizeof(kz_messages[0]);

const kz_message_info* kz_message_find(u8 code) {
  u8 i;
  for (i = 0; i < kz_message_count; ++i) {
    if (kz_messages[i].code == code) return &kz_messages[i];
  }
  return NULL;
}

const char* kz_refusal_text(u8 reason) {
  switch (reason) {
    case KZ_REFUSED_UNKNOWN_TYPE:
      return "unknown type of message";
    case KZ_REFUSED_LENGTH:
      return "wrong length";
    case KZ_REFUSED_RANGE:
      return "value out of range";
    case KZ_REFUSED_LIMIT:
      return "target outside the joint's limits";
    case KZ_REFUSED_DISABLED:
      return "joint is off";
    case KZ_REFUSED_FAULT:
      return "a fault must go away first";
    case KZ_REFUSED_BUSY:
      return "previous reply is still being sent";
    default:
      return "unknown reason";
  }
}

const char* kz_status_name(u16 flag) {
  switch (flag) {
    case KZ_STATUS_ENABLED:
      return "ENABLED";
    case KZ_STATUS_MOVING:
      return "MOVING";
    case KZ_STATUS_LINK_WATCHDOG:
      return "LINK_WATCHDOG";
    case KZ_STATUS_MISSED_TICK:
      return "MISSED_TICK";
    case KZ_STATUS_POT_FAULT:
      return "POT_FAULT";
    case KZ_STATUS_SUPPLY_FAULT:
      return "SUPPLY_FAULT";
    default:
      return NULL;
  }
}
