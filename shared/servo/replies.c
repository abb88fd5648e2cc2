// Replies about the board, and which request gets which reply.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/replies.h"

#include "kz_build_id.h"
#include "shared/servo/joints.h"
#include "shared/servo/safety.h"

static u8 reply_identify(const kz_servo* servo, u8* fields) {
  kz_identify_reply reply;
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

static u8 reply_health(const kz_servo* servo, u8* fields) {
  kz_health_reply reply;
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

static u8 reply_statistics(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_statistics_reply reply;
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

static u8 reply_inertial(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_inertial_reply reply;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.yaw_rate = input->analog[KZ_ANALOG_YAW_RATE];
  reply.forward = input->analog[KZ_ANALOG_FORWARD_FORCE];
  reply.left = input->analog[KZ_ANALOG_LEFT_FORCE];
  return kz_pack_inertial_reply(&reply, fields);
}

static u8 reply_self_test(const kz_servo* servo, u8* fields) {
  kz_self_test_reply reply;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.done = servo->tests_done;
  reply.failed = servo->tests_failed;
  reply.image_crc = servo->image_crc;
  reply.start_8states = servo->start_8states;
  return kz_pack_self_test_reply(&reply, fields);
}

static u8 reply_settings(const kz_servo* servo, u8 number, u8* fields) {
  const kz_joint* joint = kz_joint_of(servo, number);
  kz_settings_reply reply;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.joint = number;
  reply.kp = kz_unscaled_kp(joint->kp);
  reply.kd = kz_unscaled_kd(joint->kd);
  reply.dead_band = joint->dead_band;
  reply.friction = joint->friction;
  reply.ramp = joint->ramp_limit;
  reply.lower = joint->lower;
  reply.upper = joint->upper;
  return kz_pack_settings_reply(&reply, fields);
}

static u8 reply_enable(const kz_servo* servo, u8* fields) {
  kz_enable_reply reply;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.mask = servo->enabled;
  return kz_pack_enable_reply(&reply, fields);
}

static u8 reply_store(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_store_calibration_reply reply;
  reply.tick = servo->tick;
  reply.status = kz_status(servo);
  reply.sequence = input->calibration_sequence;
  reply.erases_a = input->erases_a;
  reply.erases_b = input->erases_b;
  return kz_pack_store_calibration_reply(&reply, fields);
}

u8 kz_reply(const kz_servo* servo, const kz_tick_input* input, const kz_answer* answer,
            u8* fields) {
  switch (answer->type) {
    case KZ_TYPE_identify:
      return reply_identify(servo, fields);
    case KZ_TYPE_health:
      return reply_health(servo, fields);
    case KZ_TYPE_statistics:
      return reply_statistics(servo, input, fields);
    case KZ_TYPE_self_test:
      return reply_self_test(servo, fields);
    case KZ_TYPE_inertial:
      return reply_inertial(servo, input, fields);
    case KZ_TYPE_enable:
      return reply_enable(servo, fields);
    case KZ_TYPE_settings:
      return reply_settings(servo, (u8)answer->parameter, fields);
    case KZ_TYPE_store_calibration:
      return reply_store(servo, input, fields);
    case KZ_TYPE_state:
      return (u8)(kz_put_state(servo, fields) - fields);
    case KZ_TYPE_read_targets:
      return (u8)(kz_put_read_targets(servo, answer->parameter, fields) - fields);
    case KZ_TYPE_joints:
      return (u8)(kz_put_joints(servo, answer->parameter, fields) - fields);
    case KZ_TYPE_calibration:
      return (u8)(kz_put_calibration(servo, input, fields) - fields);
    default:  // all others say only that it is done
      return (u8)(kz_put_head(servo, fields) - fields);
  }
}

u8 kz_reply_takes_two(u8 request_type) {
  return (u8)(request_type == KZ_TYPE_joints || request_type == KZ_TYPE_calibration);
}

u8 kz_reply_rest(const kz_servo* servo, const kz_answer* answer, u8* fields, u8 bytes) {
  if (answer->type != KZ_TYPE_joints) return bytes;
  return (u8)(kz_put_joints_rest(servo, answer->parameter, fields + bytes) - fields);
}

u8 kz_reply_is_large(u8 request_type) {
  return (u8)(request_type == KZ_TYPE_state || request_type == KZ_TYPE_joints ||
              request_type == KZ_TYPE_read_targets || request_type == KZ_TYPE_calibration);
}
