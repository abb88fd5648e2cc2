// Replies about the board, and which request gets which reply.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/replies.h"

#include "kz_build_id.h"
#include "shared/servo/joint_replies.h"
#include "shared/servo/joints.h"
#include "shared/servo/status.h"

// Each writes the fields of one reply and returns how many bytes: put_<name>, called in one place.
#define REPLY(name) \
  static u8 put_##name(const kz_servo* servo, const kz_tick_input* input, u32 parameter, u8* fields)

REPLY(identify_reply) {
  kz_identify_reply reply;
  (void)input;
  (void)parameter;
  reply.tick = servo->tick;
  reply.protocol_version = KZ_PROTOCOL_VERSION;
  reply.joints = KZ_JOINTS;
  reply.status = kz_status(servo);
  reply.capabilities = KZ_CAPABILITY_CALIBRATION | KZ_CAPABILITY_RAW_DRIVE | KZ_CAPABILITY_LOADER;
  if (!servo->shared_line) reply.capabilities |= KZ_CAPABILITY_TELEMETRY;
  reply.firmware_version = KZ_FIRMWARE_VERSION;
  reply.build_id = KZ_BUILD_ID;
  reply.image_crc = servo->image_crc;
  reply.reset_cause = servo->reset_cause;
  reply.watchdog_10ms = (u8)(servo->watchdog_ms / 10);
  reply.reaction = servo->reaction;
  return kz_pack_identify_reply(&reply, fields);
}

REPLY(health_reply) {
  kz_health_reply reply;
  (void)input;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.detail = servo->shutdown_detail;
  reply.shutdown_tick = servo->shutdown_tick;
  reply.supply_mv = servo->supply_mv;
  reply.supply_lowest_mv = servo->supply_lowest_mv;
  reply.temperature_dc = servo->temperature_dc;
  reply.reference = servo->reference;
  return kz_pack_health_reply(&reply, fields);
}

REPLY(statistics_reply) {
  kz_statistics_reply reply;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.busy_8states = input->busy_8states;
  reply.worst_8states = input->worst_8states;
  reply.missed_ticks = servo->missed_ticks;
  reply.frames = servo->frames;
  reply.repetitions = servo->repetitions;
  reply.refusals = servo->refusals;
  reply.bad_check = servo->bad_check;
  reply.bad_stuffing = servo->bad_stuffing;
  reply.too_short = servo->too_short;
  reply.too_long = servo->too_long;
  reply.line_errors = servo->line_errors;
  reply.overruns = servo->overruns;
  reply.idle = servo->idle;
  reply.telemetry_dropped = servo->telemetry_dropped;
  return kz_pack_statistics_reply(&reply, fields);
}

REPLY(inertial_reply) {
  kz_inertial_reply reply;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.yaw_rate = input->analog[KZ_ANALOG_YAW_RATE];
  reply.forward = input->analog[KZ_ANALOG_FORWARD_FORCE];
  reply.left = input->analog[KZ_ANALOG_LEFT_FORCE];
  return kz_pack_inertial_reply(&reply, fields);
}

REPLY(self_test_reply) {
  kz_self_test_reply reply;
  (void)input;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.done = servo->tests_done;
  reply.failed = servo->tests_failed;
  reply.image_crc = servo->image_crc;
  reply.start_8states = servo->start_8states;
  return kz_pack_self_test_reply(&reply, fields);
}

REPLY(settings_reply) {
  const kz_joint* joint = kz_joint_of(servo, (u8)parameter);
  kz_settings_reply reply;
  (void)input;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.joint = (u8)parameter;
  reply.kp = kz_unscaled_kp(joint->kp);
  reply.kd = kz_unscaled_kd(joint->kd);
  reply.dead_band = joint->dead_band;
  reply.friction = joint->friction;
  reply.ramp = joint->ramp_limit;
  reply.lower = joint->lower;
  reply.upper = joint->upper;
  return kz_pack_settings_reply(&reply, fields);
}

REPLY(enable_reply) {
  kz_enable_reply reply;
  (void)input;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.mask = servo->enabled;
  return kz_pack_enable_reply(&reply, fields);
}

REPLY(store_calibration_reply) {
  kz_store_calibration_reply reply;
  (void)parameter;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.sequence = input->calibration_sequence;
  reply.erases_a = input->erases_a;
  reply.erases_b = input->erases_b;
  return kz_pack_store_calibration_reply(&reply, fields);
}

REPLY(state_reply) {
  (void)input;
  (void)parameter;
  return (u8)(kz_put_state(servo, fields) - fields);
}

REPLY(read_targets_reply) {
  (void)input;
  return (u8)(kz_put_read_targets(servo, parameter, fields) - fields);
}

REPLY(joints_reply) {
  (void)input;
  return (u8)(kz_put_joints(servo, parameter, fields) - fields);
}

REPLY(calibration_reply) {
  (void)parameter;
  return (u8)(kz_put_calibration(servo, input, fields) - fields);
}

// One case for each kind of message; the type of the request is that of its reply without bit 7.
#define CASE_QUERY(name)
#define CASE_JOINT_QUERY(name)
#define CASE_COMMAND(name)
#define CASE_BULK_COMMAND(name)
#define CASE_FLASH_COMMAND(name)
#define CASE_RESTART_COMMAND(name)
#define CASE_REPLY(name)           \
  case KZ_TYPE_##name & ~KZ_REPLY: \
    return put_##name(servo, input, answer->parameter, fields);
#define CASE_LARGE_REPLY(name) CASE_REPLY(name)
#define CASE_SPLIT_REPLY(name) CASE_REPLY(name)
#define CASE_ACKNOWLEDGEMENT(name)
#define CASE_REFUSAL(name)
#define CASE_TELEMETRY(name)

u8 kz_reply(const kz_servo* servo, const kz_tick_input* input, const kz_answer* answer,
            u8* fields) {
  switch (answer->type) {
#define KZ_MESSAGE(name, code, kind, text) CASE_##kind(name)
#include "shared/protocol/messages.def"
    default:  // an acknowledgement
      return (u8)(kz_put_head(servo, fields) - fields);
  }
}

// Conditions on KZ_KIND_* are known to the compiler: what is left compares the type with a few codes.
// clang-format off
u8 kz_reply_takes_two(u8 request_type) {
  return (u8)(0
#define KZ_MESSAGE(name, code, kind, text) \
  || (KZ_KIND_##kind == KZ_KIND_SPLIT_REPLY && request_type == ((code) & ~KZ_REPLY))
#include "shared/protocol/messages.def"
  );
}

u8 kz_reply_is_large(u8 request_type) {
  return (u8)(0
#define KZ_MESSAGE(name, code, kind, text) \
  || ((KZ_KIND_##kind == KZ_KIND_LARGE_REPLY || KZ_KIND_##kind == KZ_KIND_SPLIT_REPLY) && \
      request_type == ((code) & ~KZ_REPLY))
#include "shared/protocol/messages.def"
  );
}
// clang-format on

u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes) {
  if (answer->type != KZ_TYPE_joints) return bytes;
  return (u8)(kz_put_joints_rest(servo, answer->parameter, fields + bytes) - fields);
}

void kz_send(kz_servo* servo, u8 type, u8 sequence, u8 field_bytes) {
  u8* body = servo->sender.body;
  body[KZ_BODY_ADDRESS] = servo->address;
  body[KZ_BODY_TYPE] = type;
  body[KZ_BODY_SEQUENCE] = sequence;
  kz_sender_start(&servo->sender, (u8)(KZ_HEADER_SIZE + field_bytes));
}
