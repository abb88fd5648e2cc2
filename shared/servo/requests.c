// Execution of requests and scheduling of their replies.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/requests.h"

#include "shared/protocol/bytes.h"
#include "shared/servo/commands.h"
#include "shared/servo/handlers.h"
#include "shared/servo/joints.h"
#include "shared/servo/replies.h"
#include "shared/servo/status.h"
#include "shared/servo/telemetry_frames.h"

#define WORK_LENGTH 13  // bytes of body

#define NOT_INLINE __attribute__((noinline))

// Places of fields.
#define UNLOCK_SECONDS 2
#define RAW_DRIVE_JOINT 0
#define RAW_DRIVE_DUTY 1

void kz_requests_init(kz_servo* servo) {
  kz_answer* answer = servo->remembered;
  u8 left;
  for (left = KZ_REQUESTS_REMEMBERED; left != 0; --left) {
    // An empty entry must not match a request as its repetition with a success.
    answer->reason = KZ_REFUSED_UNKNOWN_TYPE;
    answer->detail = KZ_NO_DETAIL;
    ++answer;
  }
}

// array[number], in 16 bits.
static kz_answer* slot(kz_answer* array, u8 number) {
  return (kz_answer*)((u8*)array + (u16)((u16)number * (u16)sizeof(kz_answer)));
}

// Member by member: there is no library to copy structures.
static void copy(kz_answer* to, const kz_answer* from) {
  to->parameter = from->parameter;
  to->crc = from->crc;
  to->type = from->type;
  to->sequence = from->sequence;
  to->reason = from->reason;
  to->detail = from->detail;
}

// The same request once more? Its CRC is that of the whole body.
static const kz_answer* remembered(const kz_servo* servo, u8 type, u8 sequence) {
  const kz_answer* answer = servo->remembered;
  u8 left;
  for (left = KZ_REQUESTS_REMEMBERED; left != 0; --left) {
    if (answer->crc == servo->receiver.crc && answer->type == type && answer->sequence == sequence)
      return answer;
    ++answer;
  }
  return 0;
}

static const kz_answer* execute(kz_servo* servo, u8 type, u8 sequence) {
  kz_answer* answer = slot(servo->remembered, servo->memory_next);
  kz_outcome outcome;
  servo->memory_next = (u8)((servo->memory_next + 1) % KZ_REQUESTS_REMEMBERED);
  answer->parameter = 0;
  answer->crc = servo->receiver.crc;
  answer->type = type;
  answer->sequence = sequence;
  outcome = kz_command(servo, type, servo->receiver.body + KZ_HEADER_SIZE,
                       (u8)(servo->receiver.length - KZ_HEADER_SIZE), &answer->parameter);
  answer->reason = (u8)(outcome >> 8);
  answer->detail = (u8)outcome;
  if (answer->reason != 0 && answer->reason != KZ_PENDING) kz_count(&servo->refusals);
  return answer;
}

// The part of a repeated request that is executed again: what it switches off, never what it switches on. Not
// inline: requests that are no repetition would pay for its registers.
static NOT_INLINE void switch_off_again(kz_servo* servo, u8 type) {
  const u8* fields = servo->receiver.body + KZ_HEADER_SIZE;
  switch (type) {
    case KZ_TYPE_enable:
      kz_joints_enable(servo, servo->enabled & kz_get_u32(fields));
      break;
    case KZ_TYPE_clear:
      if (servo->holding) kz_joints_enable(servo, 0);
      break;
    case KZ_TYPE_unlock:
      if (fields[UNLOCK_SECONDS] == 0) servo->unlocked_ms = servo->raw_ms = 0;
      break;
    case KZ_TYPE_raw_drive:
      if (fields[RAW_DRIVE_JOINT] != servo->raw_joint || kz_get_u16(fields + RAW_DRIVE_DUTY) == 0) {
        servo->raw_ms = 0;
      }
      break;
    default:
      break;
  }
}

// With a `stop` as the one too many before, the new one takes its place.
static void enqueue(kz_servo* servo, const kz_answer* answer) {
  if (servo->replying + servo->queued == KZ_QUEUE) --servo->queued;
  copy(slot(servo->queue, servo->queued), answer);
  ++servo->queued;
}

// Refuses with BUSY a request beyond the queue, or one that comes while an action is pending.
static void turn_away(kz_servo* servo, u8 type, u8 sequence, u8 answered) {
  kz_count(&servo->refusals);
  if (!answered) return;
  servo->refuse_busy = 1;
  servo->busy_type = type;
  servo->busy_sequence = sequence;
}

// Requests that set something for many joints. On the wire they take more than a tick, so there is at
// most one of them in a tick.
static u8 is_work(u8 type, u8 length) {
  return (u8)(length >= WORK_LENGTH || type == KZ_TYPE_enable);
}

void kz_request_received(kz_servo* servo) {
  const u8* body = servo->receiver.body;
  const u8 type = body[KZ_BODY_TYPE];
  const u8 sequence = body[KZ_BODY_SEQUENCE];
  const u8 answered = (u8)(body[KZ_BODY_ADDRESS] == servo->address);
  const kz_answer* answer;
  if (!answered && body[KZ_BODY_ADDRESS] != KZ_ADDRESS_ALL) return;
  if (type & KZ_REPLY) return;  // a reply is not a request, whoever sent it
  servo->silent_ms = 0;
  ++servo->frames;
  if (type != KZ_TYPE_stop) {
    if (servo->action != KZ_ACTION_NONE ||
        (answered && servo->replying + servo->queued >= KZ_REQUESTS_UNDER_WAY)) {
      turn_away(servo, type, sequence, answered);
      return;
    }
  }
  // `stop` is always executed, whatever is remembered of an earlier one.
  answer = type == KZ_TYPE_stop ? 0 : remembered(servo, type, sequence);
  if (answer != 0) {
    kz_count(&servo->repetitions);
    if (answer->reason == 0) switch_off_again(servo, type);
  } else {
    answer = execute(servo, type, sequence);
  }
  if (answered) enqueue(servo, answer);
  if (is_work(type, servo->receiver.length)) servo->tx_throttled = 1;
}

static void finish(kz_answer* answer, u8 count, u16 outcome) {
  for (; count != 0; --count) {
    if (answer->reason == KZ_PENDING) {
      answer->reason = (u8)(outcome >> 8);
      answer->detail = (u8)outcome;
    }
    ++answer;
  }
}

void kz_requests_finish(kz_servo* servo, u16 outcome) {
  finish(servo->remembered, KZ_REQUESTS_REMEMBERED, outcome);
  finish(servo->queue, servo->queued, outcome);
}

u8 kz_requests_leave_room(const kz_servo* servo) {
  if (kz_sender_busy(&servo->sender)) return 0;
  if (servo->queued != 0) return (u8)(servo->queue[0].reason == KZ_PENDING);
  return (u8)!servo->refuse_busy;
}

static void send_refusal(kz_servo* servo, u8 type, u8 sequence, u8 reason, u8 detail) {
  kz_refused refused;
  refused.tick = servo->tick;
  refused.status = kz_status(servo);
  refused.request = type;
  refused.reason = reason;
  refused.detail = detail;
  kz_send(servo, KZ_TYPE_refused, sequence,
          kz_pack_refused(&refused, servo->sender.body + KZ_HEADER_SIZE));
}

static u8 is_large(const kz_answer* answer) {
  return (u8)(answer->reason == 0 && kz_reply_is_large(answer->type));
}

// The reply to queue[0], which leaves the queue; one of two parts is only prepared at first.
static void send_answer(kz_servo* servo, const kz_tick_input* input) {
  u8* const fields = servo->sender.body + KZ_HEADER_SIZE;
  kz_answer* answer = servo->queue;
  u8 left;
  if (answer->reason != 0) {
    send_refusal(servo, answer->type, answer->sequence, answer->reason, answer->detail);
  } else {
    u8 bytes = servo->prepared;
    if (bytes == 0) {
      bytes = kz_reply(servo, input, answer, fields);
      if (kz_reply_takes_two(answer->type)) {
        servo->prepared = bytes;
        return;
      }
    } else {
      servo->prepared = 0;
      bytes = kz_reply_rest(servo, answer, fields, bytes);
    }
    kz_send(servo, (u8)(answer->type | KZ_REPLY), answer->sequence, bytes);
  }
  servo->replying = 1;
  --servo->queued;
  for (left = servo->queued; left != 0; --left) {
    copy(answer, answer + 1);
    ++answer;
  }
}

void kz_requests_answer(kz_servo* servo, const kz_tick_input* input) {
  if (kz_sender_busy(&servo->sender)) return;
  if (servo->queued != 0) {
    if (servo->queue[0].reason == KZ_PENDING) return;
    if (is_large(servo->queue)) {
      if (servo->tx_throttled) return;
      servo->tx_throttled = 1;
    }
    send_answer(servo, input);
  } else if (servo->refuse_busy) {
    send_refusal(servo, servo->busy_type, servo->busy_sequence, KZ_REFUSED_BUSY, KZ_NO_DETAIL);
    servo->refuse_busy = 0;
  } else if (servo->telemetry_due != 0 && !servo->tx_throttled && servo->action == KZ_ACTION_NONE) {
    kz_telemetry_send(servo, input);
    servo->tx_throttled = 1;
  }
}
