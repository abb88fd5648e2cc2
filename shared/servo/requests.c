// What the board does when a frame has come, and what it answers.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/requests.h"

#include "kz_build_id.h"
#include "shared/protocol/messages.h"
#include "shared/servo/commands.h"
#include "shared/servo/safety.h"

// Where the header's bytes stand in a body.
#define ADDRESS 0
#define TYPE 1
#define SEQUENCE 2

// Each writes the fields of a reply, and returns how many bytes.

static u8 reply_identify(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_identify_reply reply;
  reply.tick = input->tick;
  reply.status = kz_status(servo);
  reply.protocol_version = KZ_PROTOCOL_VERSION;
  reply.joints = KZ_JOINTS;
  reply.firmware_version = KZ_FIRMWARE_VERSION;
  reply.build_id = KZ_BUILD_ID;
  reply.capabilities = 0;
  reply.image_crc = servo->image_crc;
  reply.reset_cause = servo->reset_cause;
  reply.watchdog_10ms = (u8)(servo->watchdog_ms / 10);
  reply.reaction = servo->reaction;
  return kz_pack_identify_reply(&reply, fields);
}

static u8 reply_enable(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_enable_reply reply;
  reply.tick = input->tick;
  reply.mask = servo->enabled;
  reply.status = kz_status(servo);
  return kz_pack_enable_reply(&reply, fields);
}

static u8 reply_state(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  const kz_joint* joint = servo->joint;
  kz_state_reply reply;
  u8 i;
  reply.tick = input->tick;
  reply.status = kz_status(servo);
  reply.supply_mv = servo->supply_mv;
  for (i = 0; i < KZ_JOINTS; ++i) {
    reply.angle[i] = joint->angle;
    ++joint;
  }
  return kz_pack_state_reply(&reply, fields);
}

static u8 reply_heartbeat(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_heartbeat_reply reply;
  reply.tick = input->tick;
  reply.status = kz_status(servo);
  return kz_pack_heartbeat_reply(&reply, fields);
}

static u8 reply_statistics(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_statistics_reply reply;
  reply.tick = input->tick;
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
  reply.overruns = 0;
  reply.idle = 0;
  reply.telemetry_dropped = 0;
  return kz_pack_statistics_reply(&reply, fields);
}

// `targets` and `gains` are answered alike.
static u8 reply_taken(const kz_servo* servo, const kz_tick_input* input, u8* fields) {
  kz_targets_reply reply;
  reply.tick = input->tick;
  reply.status = kz_status(servo);
  return kz_pack_targets_reply(&reply, fields);
}

static u8 reply_fields(const kz_servo* servo, const kz_tick_input* input, u8 type, u8* fields) {
  switch (type) {
    case KZ_TYPE_identify:
      return reply_identify(servo, input, fields);
    case KZ_TYPE_enable:
      return reply_enable(servo, input, fields);
    case KZ_TYPE_state:
      return reply_state(servo, input, fields);
    case KZ_TYPE_statistics:
      return reply_statistics(servo, input, fields);
    case KZ_TYPE_heartbeat:
      return reply_heartbeat(servo, input, fields);
    default:
      return reply_taken(servo, input, fields);
  }
}

static void send(kz_servo* servo, u8 type, u8 sequence, u8 field_bytes) {
  u8* body = servo->sender.body;
  body[ADDRESS] = servo->address;
  body[TYPE] = type;
  body[SEQUENCE] = sequence;
  kz_sender_start(&servo->sender, (u8)(KZ_HEADER_SIZE + field_bytes));
}

static void send_refusal(kz_servo* servo, const kz_tick_input* input, u8 type, u8 sequence,
                         kz_outcome outcome) {
  kz_refused refused;
  refused.tick = input->tick;
  refused.status = kz_status(servo);
  refused.request = type;
  refused.reason = outcome.reason;
  refused.detail = outcome.detail;
  send(servo, KZ_TYPE_refused, sequence,
       kz_pack_refused(&refused, servo->sender.body + KZ_HEADER_SIZE));
}

// The same request once more? Its CRC is that of the whole body.
static u8 is_repetition(const kz_servo* servo, u8 type, u8 sequence) {
  return (u8)(servo->last_type == type && servo->last_sequence == sequence &&
              servo->last_crc == servo->receiver.crc);
}

void kz_request_received(kz_servo* servo, const kz_tick_input* input) {
  const u8* body = servo->receiver.body;
  const u8 type = body[TYPE];
  const u8 sequence = body[SEQUENCE];
  const u8 answered = (u8)(body[ADDRESS] == servo->address);
  kz_outcome outcome;
  if (!answered && body[ADDRESS] != KZ_ADDRESS_ALL) return;
  if (type & KZ_REPLY) return;  // a reply is not a request, whoever sent it
  servo->silent_ms = 0;
  ++servo->frames;

  if (answered && kz_sender_busy(&servo->sender)) {
    servo->busy_type = type;
    servo->busy_sequence = sequence;
    return;
  }
  if (!is_repetition(servo, type, sequence)) {
    outcome = kz_command(servo, type, body + KZ_HEADER_SIZE,
                         (u8)(servo->receiver.length - KZ_HEADER_SIZE));
    servo->outcome = outcome.reason;
    servo->outcome_detail = outcome.detail;
    servo->last_type = type;
    servo->last_sequence = sequence;
    servo->last_crc = servo->receiver.crc;
    if (outcome.reason != 0 && servo->refusals < 0xFFFF) ++servo->refusals;
  } else if (servo->repetitions < 0xFFFF) {
    ++servo->repetitions;
  }
  if (!answered) return;
  if (servo->outcome != 0) {
    outcome.reason = servo->outcome;
    outcome.detail = servo->outcome_detail;
    send_refusal(servo, input, type, sequence, outcome);
  } else {
    send(servo, (u8)(type | KZ_REPLY), sequence,
         reply_fields(servo, input, type, servo->sender.body + KZ_HEADER_SIZE));
  }
}

void kz_refuse_busy(kz_servo* servo, const kz_tick_input* input) {
  kz_outcome outcome;
  outcome.reason = KZ_REFUSED_BUSY;
  outcome.detail = KZ_NO_DETAIL;
  send_refusal(servo, input, servo->busy_type, servo->busy_sequence, outcome);
  servo->busy_type = 0;
}
