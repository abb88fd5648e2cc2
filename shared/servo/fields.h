// The state of the servo as a list of fields, to compare, print and record it.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_FIELDS_H
#define KAZ_SHARED_SERVO_FIELDS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// `count` times a number of `size` bytes: element i is at offset + i * stride from the start of
// struct kz_servo, little-endian on the PC and big-endian on the H8, at the same place on both.
typedef struct kz_state_field {
  const char* name;  // "enabled", "joint.angle", "receiver.crc"
  u16 offset;
  u16 stride;
  u8 size;  // 1, 2 or 4
  u8 is_signed;
  u8 count;
} kz_state_field;

extern const kz_state_field kz_state_fields[];
extern const u8 kz_state_field_count;

// Bytes of struct kz_servo on the H8.
extern const u16 kz_state_size_h8;

// Of the sources that this program was built from; an image's header has that of its own.
extern const u32 kz_build_id;

#ifdef __cplusplus
}
#endif

#endif
