// Reflection of struct kz_servo: a list of its fields, to compare, print and record the state.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_FIELDS_H
#define KAZ_SHARED_SERVO_FIELDS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// A field: `count` numbers of `size` bytes each. Element i begins `offset + i * stride` bytes after the
// beginning of struct kz_servo. This position is equal on the H8 and on the PC. Numbers are big-endian on the
// H8 and little-endian on the PC.
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

// Size of struct kz_servo on the H8, bytes.
extern const u16 kz_state_size_h8;

// CRC-32 of the firmware sources from which this program was built. A firmware image has its own build id.
extern const u32 kz_build_id;

#ifdef __cplusplus
}
#endif

#endif
