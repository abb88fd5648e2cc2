// The state of the servo as a list of fields.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/fields.h"

#include <stddef.h>

#include "kz_build_id.h"

#define SIGNED_u8 0
#define SIGNED_u16 0
#define SIGNED_s16 1
#define SIGNED_u32 0
#define NUMBERS(type, member, element, times) \
  {#member, offsetof(kz_servo, element), sizeof(type), sizeof(type), SIGNED_##type, (times)},
#define PART(type, member) NUMBERS(type, member, member, 1)
#define SERVO_FIELD(type, name) PART(type, name)
#define JOINT_FIELD(type, name)                            \
  {                                                        \
      "joint." #name,   offsetof(kz_servo, joint[0].name), \
      sizeof(kz_joint), sizeof(type),                      \
      SIGNED_##type,    KZ_JOINTS},

#define ANSWER_FIELD(array, times, type, name)           \
  {#array "." #name,  offsetof(kz_servo, array[0].name), \
   sizeof(kz_answer), sizeof(type),                      \
   SIGNED_##type,     times},
#define REMEMBERED_FIELD(type, name) ANSWER_FIELD(remembered, KZ_REQUESTS_REMEMBERED, type, name)
#define QUEUE_FIELD(type, name) ANSWER_FIELD(queue, KZ_QUEUE, type, name)

const kz_state_field kz_state_fields[] = {
    KZ_SERVO_FIELDS(SERVO_FIELD)        //
    KZ_ANSWER_FIELDS(REMEMBERED_FIELD)  //
    KZ_ANSWER_FIELDS(QUEUE_FIELD)       //
    KZ_JOINT_FIELDS(JOINT_FIELD)        //
    PART(u16, receiver.crc)             //
    PART(u8, receiver.length)           //
    PART(u8, receiver.state) NUMBERS(u8, receiver.body, receiver.body[0], KZ_BODY_MAX + 4)
        PART(u8, receiver.silent_ms) PART(u16, sender.crc)  //
    PART(u8, sender.length)                                 //
    PART(u8, sender.next)                                   //
    PART(u8, sender.first)                                  //
    PART(u8, sender.stage)                                  //
    NUMBERS(u8, sender.body, sender.body[0], KZ_BODY_MAX)   //
};

const u8 kz_state_field_count = sizeof(kz_state_fields) / sizeof(kz_state_fields[0]);

// The H8 rounds a structure up to an even size; the PC to a multiple of 4.
const u16 kz_state_size_h8 = (offsetof(kz_servo, sender.body) + KZ_BODY_MAX + 1) / 2 * 2;

const u32 kz_build_id = KZ_BUILD_ID;
