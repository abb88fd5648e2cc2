// Dispatch of requests, generated from messages.def.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/commands.h"

#include "shared/servo/joints.h"

// What the reply to a JOINT_QUERY is about: a mask of joints, or a joint.

static kz_outcome select_read_targets(const kz_read_targets* request, u32* parameter) {
  *parameter = request->mask;
  return KZ_DONE;
}

static kz_outcome select_joints(const kz_joints* request, u32* parameter) {
  if (kz_count_joints(request->mask) > KZ_JOINTS_PER_REPLY) {
    return KZ_REFUSE(KZ_REFUSED_RANGE, 0);
  }
  *parameter = request->mask;
  return KZ_DONE;
}

static kz_outcome select_settings(const kz_settings* request, u32* parameter) {
  *parameter = request->joint;
  return KZ_DONE;
}

// Unpacks the fields into `request` and checks their bounds. Conditions on KZ_SIZE_<name> are known
// to the compiler: a message without fields is only checked for its length.
#define TAKE(name)                                                                            \
  if (KZ_SIZE_##name == 0 ? length != 0 : !kz_unpack_##name(&request.name, fields, length)) { \
    return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);                                        \
  }                                                                                           \
  wrong = KZ_SIZE_##name == 0 ? KZ_IN_BOUNDS : kz_check_##name(&request.name);                \
  if (wrong != KZ_IN_BOUNDS) return KZ_REFUSE(KZ_REFUSED_RANGE, wrong);

// One case of the switch for each kind of message.
#define CASE_QUERY(name)                                                \
  case KZ_TYPE_##name:                                                  \
    if (length != 0) return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL); \
    return KZ_DONE;
#define CASE_JOINT_QUERY(name) \
  case KZ_TYPE_##name:         \
    TAKE(name)                 \
    return select_##name(&request.name, parameter);
#define CASE_COMMAND(name) \
  case KZ_TYPE_##name:     \
    TAKE(name)             \
    return kz_do_##name(servo, KZ_SIZE_##name != 0 ? &request.name : 0);
#define CASE_BULK_COMMAND(name) \
  case KZ_TYPE_##name:          \
    return kz_do_##name(servo, fields, length);
#define CASE_FLASH_COMMAND(name) CASE_COMMAND(name)
#define CASE_RESTART_COMMAND(name) CASE_COMMAND(name)
#define CASE_REPLY(name)
#define CASE_LARGE_REPLY(name)
#define CASE_SPLIT_REPLY(name)
#define CASE_ACKNOWLEDGEMENT(name)
#define CASE_REFUSAL(name)
#define CASE_TELEMETRY(name)

// Members of the union of all requests that are unpacked.
#define MEMBER_QUERY(name)
#define MEMBER_JOINT_QUERY(name) kz_##name name;
#define MEMBER_COMMAND(name) kz_##name name;
#define MEMBER_BULK_COMMAND(name)
#define MEMBER_FLASH_COMMAND(name) kz_##name name;
#define MEMBER_RESTART_COMMAND(name) kz_##name name;
#define MEMBER_REPLY(name)
#define MEMBER_LARGE_REPLY(name)
#define MEMBER_SPLIT_REPLY(name)
#define MEMBER_ACKNOWLEDGEMENT(name)
#define MEMBER_REFUSAL(name)
#define MEMBER_TELEMETRY(name)

kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length, u32* parameter) {
  union {
#define KZ_MESSAGE(name, code, kind, text) MEMBER_##kind(name)
#include "shared/protocol/messages.def"
  } request;
  u8 wrong;
  switch (type) {
#define KZ_MESSAGE(name, code, kind, text) CASE_##kind(name)
#include "shared/protocol/messages.def"
    default:
      return KZ_REFUSE(KZ_REFUSED_UNKNOWN_TYPE, KZ_NO_DETAIL);
  }
}
