// Frames: a receiver and a sender that work byte by byte, with a bounded amount of work for each.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/frame.h"

#include "shared/protocol/crc16.h"

#define CRC_START 0xFFFF
#define CHECK_SIZE 3

enum receiver_state {
  HUNTING,      // no zero seen yet: what comes may be the rest of a frame
  BETWEEN,      // after a zero
  FIRST_BLOCK,  // in a frame, before its first stuffing byte
  IN_FRAME,
  LINE_ERROR,  // the rest of the frame is skipped
  TOO_LONG,
};

enum sender_stage { IDLE, OPENING, BLOCK, COPYING, CHECK_HIGH, CHECK_MIDDLE, CHECK_LOW, CLOSING };

// The 16 bits of a CRC as three bytes that are never zero.
static u8 check_high(u16 crc) {
  return (u8)(0x80 | (crc >> 14));
}
static u8 check_middle(u16 crc) {
  return (u8)(0x80 | ((crc >> 7) & 0x7F));
}
static u8 check_low(u16 crc) {
  return (u8)(0x80 | (crc & 0x7F));
}

void kz_receiver_init(kz_receiver* receiver) {
  u8 i;
  receiver->crc = CRC_START;
  receiver->length = 0;
  receiver->run = 0;
  receiver->state = HUNTING;
  receiver->held = 0;
  for (i = 0; i < CHECK_SIZE; ++i) receiver->hold[i] = 0;
  for (i = 0; i < KZ_BODY_MAX; ++i) receiver->body[i] = 0;
}

static void begin_frame(kz_receiver* receiver, u8 state) {
  receiver->crc = CRC_START;
  receiver->length = 0;
  receiver->run = 0;
  receiver->held = 0;
  receiver->state = state;
}

// One byte of the stuffed body.
static inline void unstuff(kz_receiver* receiver, u8 byte) {
  const u8 run = receiver->run;
  const u8 length = receiver->length;
  receiver->crc = kz_crc16_step(receiver->crc, byte);
  if (run == 0) {
    receiver->run = (u8)(byte - 1);
    if (receiver->state == FIRST_BLOCK) {
      receiver->state = IN_FRAME;
      return;
    }
    byte = 0;  // each block but the last stands for its bytes and a zero
  } else {
    receiver->run = (u8)(run - 1);
  }
  if (length < KZ_BODY_MAX) {
    receiver->body[length] = byte;
    receiver->length = (u8)(length + 1);
  } else {
    receiver->state = TOO_LONG;
  }
}

// The zero after a frame has come.
static u8 end_frame(const kz_receiver* receiver) {
  switch (receiver->state) {
    case HUNTING:
    case BETWEEN:
      return KZ_RECEIVE_MORE;
    case LINE_ERROR:
      return KZ_RECEIVE_LINE_ERROR;
    case TOO_LONG:
      return KZ_RECEIVE_TOO_LONG;
    case FIRST_BLOCK:
      return KZ_RECEIVE_TOO_SHORT;
    default:
      break;
  }
  if (receiver->hold[0] != check_high(receiver->crc) ||
      receiver->hold[1] != check_middle(receiver->crc) ||
      receiver->hold[2] != check_low(receiver->crc)) {
    return KZ_RECEIVE_BAD_CHECK;
  }
  if (receiver->run != 0) return KZ_RECEIVE_BAD_STUFFING;
  if (receiver->length < KZ_HEADER_SIZE) return KZ_RECEIVE_TOO_SHORT;
  return KZ_RECEIVE_FRAME;
}

u8 kz_receive(kz_receiver* receiver, u8 byte, u8 line_error) {
  u8 oldest;
  if (line_error) {
    // A zero with an error (a break, for one) is damage, not a delimiter.
    if (receiver->state != HUNTING) receiver->state = LINE_ERROR;
    return KZ_RECEIVE_MORE;
  }
  if (byte == 0) {
    const u8 result = end_frame(receiver);
    receiver->state = BETWEEN;  // body and length stay for the caller until the next byte
    return result;
  }
  if (receiver->state == BETWEEN) begin_frame(receiver, FIRST_BLOCK);
  if (receiver->state != FIRST_BLOCK && receiver->state != IN_FRAME) return KZ_RECEIVE_MORE;

  // Nobody knows yet whether this byte belongs to the check, so the last three wait.
  if (receiver->held < CHECK_SIZE) {
    receiver->hold[receiver->held++] = byte;
    return KZ_RECEIVE_MORE;
  }
  oldest = receiver->hold[0];
  receiver->hold[0] = receiver->hold[1];
  receiver->hold[1] = receiver->hold[2];
  receiver->hold[2] = byte;
  unstuff(receiver, oldest);
  return KZ_RECEIVE_MORE;
}

void kz_sender_init(kz_sender* sender) {
  u8 i;
  sender->crc = CRC_START;
  sender->length = 0;
  sender->next = 0;
  sender->run = 0;
  sender->stage = IDLE;
  for (i = 0; i < KZ_BODY_MAX; ++i) sender->body[i] = 0;
}

u8 kz_sender_busy(const kz_sender* sender) {
  return (u8)(sender->stage != IDLE);
}

void kz_sender_start(kz_sender* sender, u8 body_length) {
  sender->crc = CRC_START;
  sender->length = body_length;
  sender->next = 0;
  sender->run = 0;
  sender->stage = OPENING;
}

// Length of the block that starts at `next`: the bytes before the next zero, or before the end.
static u8 block_run(const kz_sender* sender) {
  const u8* byte = sender->body + sender->next;
  const u8 left = (u8)(sender->length - sender->next);
  u8 run = 0;
  while (run < left && *byte != 0) {
    ++byte;
    ++run;
  }
  return run;
}

// After a block: the zero it stands for is skipped; at the end of the body the check follows.
static void end_block(kz_sender* sender) {
  if (sender->next >= sender->length) {
    sender->stage = CHECK_HIGH;
  } else {
    ++sender->next;
    sender->stage = BLOCK;
  }
}

// The rest of the current block, as far as there is room. Returns how many bytes.
static u8 copy_block(kz_sender* sender, u8* wire, u8 room) {
  const u8* from = sender->body + sender->next;
  const u8 count = sender->run < room ? sender->run : room;
  u16 crc = sender->crc;
  u8 left = count;
  while (left != 0) {
    const u8 byte = *from++;
    *wire++ = byte;
    crc = kz_crc16_step(crc, byte);
    --left;
  }
  sender->crc = crc;
  sender->next = (u8)(sender->next + count);
  sender->run = (u8)(sender->run - count);
  if (sender->run == 0) end_block(sender);
  return count;
}

// Every byte that is not copied from the body.
static u8 other_byte(kz_sender* sender) {
  u8 byte = 0;
  switch (sender->stage) {
    case OPENING:
      sender->stage = BLOCK;
      break;
    case BLOCK:
      sender->run = block_run(sender);
      byte = (u8)(sender->run + 1);
      sender->crc = kz_crc16_step(sender->crc, byte);
      sender->stage = COPYING;
      if (sender->run == 0) end_block(sender);
      break;
    case CHECK_HIGH:
      byte = check_high(sender->crc);
      sender->stage = CHECK_MIDDLE;
      break;
    case CHECK_MIDDLE:
      byte = check_middle(sender->crc);
      sender->stage = CHECK_LOW;
      break;
    case CHECK_LOW:
      byte = check_low(sender->crc);
      sender->stage = CLOSING;
      break;
    default:
      sender->stage = IDLE;
      sender->length = 0;
      break;
  }
  return byte;
}

u8 kz_sender_take(kz_sender* sender, u8* wire, u8 room) {
  u8 count = 0;
  while (count < room && sender->stage != IDLE) {
    if (sender->stage == COPYING) {
      count = (u8)(count + copy_block(sender, wire + count, (u8)(room - count)));
    } else {
      wire[count++] = other_byte(sender);
    }
  }
  return count;
}
