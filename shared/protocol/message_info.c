// The message table as data.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/message_info.h"

#include <stddef.h>

#define LOW_u8 0
#define HIGH_u8 0xFF
#define LOW_u16 0
#define HIGH_u16 0xFFFF
#define LOW_s16 (-32768)
#define HIGH_s16 32767
#define LOW_u32 0
#define HIGH_u32 0xFFFFFFFFLL

// Each table ends in an empty entry, so that a message without fields has a table too.
#define KZ_MESSAGE(name, code, kind, text) static const kz_field_info fields_of_##name[] = {
#define KZ_FIELD(type, name, unit, text) \
  {#type, #name, unit, text, NULL, LOW_##type, HIGH_##type, sizeof(type), 1, 0},
#define KZ_BOUNDED(type, name, low, high, unit, text) \
  {#type, #name, unit, text, NULL, (low), (high), sizeof(type), 1, 1},
#define KZ_ARRAY(type, name, count, unit, text) \
  {#type, #name, unit, text, NULL, LOW_##type, HIGH_##type, sizeof(type), count, 0},
#define KZ_MASKED(type, name, mask, most, unit, text) \
  {#type, #name, unit, text, #mask, LOW_##type, HIGH_##type, sizeof(type), (most), 0},
#define KZ_END()                                  \
  { NULL, NULL, NULL, NULL, NULL, 0, 0, 0, 0, 0 } \
  }                                               \
  ;
#include "shared/protocol/messages.def"

const kz_message_info kz_messages[] = {
#define KZ_MESSAGE(name, code, kind, text)                                                        \
  {#name, text,           fields_of_##name, sizeof(fields_of_##name) / sizeof(kz_field_info) - 1, \
   code,  KZ_KIND_##kind, KZ_SIZE_##name},
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

u8 kz_kind_of(u8 code) {
  const kz_message_info* message = kz_message_find(code);
  return (u8)(message == NULL ? KZ_KIND_NONE : message->kind);
}

u8 kz_is_query(u8 request) {
  const u8 kind = kz_kind_of(request);
  return (u8)(kind == KZ_KIND_QUERY || kind == KZ_KIND_JOINT_QUERY);
}

u8 kz_writes_flash(u8 request) {
  return (u8)(kz_kind_of(request) == KZ_KIND_FLASH_COMMAND);
}

u8 kz_interrupts_service(u8 request) {
  const u8 kind = kz_kind_of(request);
  return (u8)(kind == KZ_KIND_FLASH_COMMAND || kind == KZ_KIND_RESTART_COMMAND);
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
      return "a shutdown is latched or its cause is present";
    case KZ_REFUSED_BUSY:
      return "too many pending requests";
    case KZ_REFUSED_ARMED:
      return "only while all motors are off";
    case KZ_REFUSED_LOCKED:
      return "only while the bench is unlocked";
    case KZ_REFUSED_SHARED_LINE:
      return "not on a line with other boards";
    case KZ_REFUSED_STORE:
      return "flash could not be written";
    default:
      return "unknown reason";
  }
}

const char* kz_shutdown_text(u8 reason) {
  switch (reason) {
    case KZ_SHUTDOWN_NONE:
      return "none";
    case KZ_SHUTDOWN_STOP:
      return "emergency stop";
    case KZ_SHUTDOWN_LINK_LOST:
      return "no request came for too long";
    case KZ_SHUTDOWN_POT:
      return "potentiometer open or short";
    case KZ_SHUTDOWN_UNDERVOLTAGE:
      return "supply too low";
    case KZ_SHUTDOWN_OVERVOLTAGE:
      return "supply too high";
    case KZ_SHUTDOWN_TEMPERATURE:
      return "motor drivers too hot";
    case KZ_SHUTDOWN_REFERENCE:
      return "A/D converter misreads its reference";
    case KZ_SHUTDOWN_STALL:
      return "motor stalled";
    case KZ_SHUTDOWN_OVERLOAD:
      return "motor overloaded";
    case KZ_SHUTDOWN_SELF_TEST:
      return "self-test failed";
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
    case KZ_STATUS_HOLDING:
      return "HOLDING";
    case KZ_STATUS_UNLOCKED:
      return "UNLOCKED";
    case KZ_STATUS_RAW_DRIVE:
      return "RAW_DRIVE";
    case KZ_STATUS_TELEMETRY:
      return "TELEMETRY";
    case KZ_STATUS_UNCALIBRATED:
      return "UNCALIBRATED";
    case KZ_STATUS_MISSED_TICK:
      return "MISSED_TICK";
    default:
      return NULL;
  }
}
