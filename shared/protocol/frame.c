// Frames: a receiver and a sender that work byte by byte, with a bounded amount of work for each.
// SPDX-License-Identifier: Apache-2.0
#include "shared/protocol/frame.h"

#include "shared/protocol/crc16.h"

#define CRC_START 0xFFFF
#define CHECK_SIZE 3
#define NOT_INLINE __attribute__((noinline))

enum receiver_state {
  HUNTING,                        // no zero seen yet: what comes may be the rest of a frame
  BETWEEN = KZ_RECEIVER_BETWEEN,  // after a zero
  IN_FRAME,
  // The rest of the frame is skipped, and its result is that of the same name.
  TOO_LONG = KZ_RECEIVE_TOO_LONG,
  LINE_ERROR = KZ_RECEIVE_LINE_ERROR,
  OVERRUN = KZ_RECEIVE_OVERRUN,
};

enum sender_stage { IDLE, OPENING, FIRST, COPYING, CHECK_HIGH, CHECK_MIDDLE, CHECK_LOW, CLOSING };

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
  receiver->state = HUNTING;
  receiver->silent_ms = 0;
  for (i = 0; i < sizeof receiver->body; ++i) receiver->body[i] = 0;
}

// Takes the stuffing out of body[0..stuffed-1], in place. Returns 0 if a block is longer than the
// rest.
static u8 unstuff(kz_receiver* receiver, u8 stuffed) {
  const u8* from = receiver->body;
  u8* to = receiver->body;
  u8 left = stuffed;
  while (left != 0) {
    u8 run = (u8)(*from++ - 1);
    --left;
    if (run > left) return 0;
    left = (u8)(left - run);
    for (; run != 0; --run) *to++ = *from++;
    if (left != 0) *to++ = 0;  // each block but the last stands for its bytes and a zero
  }
  receiver->length = (u8)(to - receiver->body);
  return 1;
}

// The zero after a frame has come. Not inline: kz_receive saves fewer registers so.
static NOT_INLINE u8 end_frame(kz_receiver* receiver) {
  const u8* check;
  if (receiver->state != IN_FRAME) {
    return receiver->state > IN_FRAME ? receiver->state : KZ_RECEIVE_MORE;
  }
  if (receiver->length <= CHECK_SIZE) return KZ_RECEIVE_TOO_SHORT;
  receiver->length = (u8)(receiver->length - CHECK_SIZE);
  check = receiver->body + receiver->length;
  if (check[0] != check_high(receiver->crc) || check[1] != check_middle(receiver->crc) ||
      check[2] != check_low(receiver->crc)) {
    return KZ_RECEIVE_BAD_CHECK;
  }
  if (!unstuff(receiver, receiver->length)) return KZ_RECEIVE_BAD_STUFFING;
  if (receiver->length < KZ_HEADER_SIZE) return KZ_RECEIVE_TOO_SHORT;
  return KZ_RECEIVE_FRAME;
}

u8 kz_receiver_waited(kz_receiver* receiver) {
  u8 result;
  if (++receiver->silent_ms < KZ_IDLE_MS) return KZ_RECEIVE_MORE;
  result = receiver->state == IN_FRAME ? KZ_RECEIVE_IDLE : receiver->state;
  receiver->state = HUNTING;
  return result;
}

static inline u8 take(kz_receiver* receiver, u8 byte) {
  u8 length;
  u8* place;
  if (byte == 0) {
    const u8 result = end_frame(receiver);
    receiver->state = BETWEEN;  // body and length stay for the caller until the next byte
    return result;
  }
  if (receiver->state != IN_FRAME) {
    if (receiver->state != BETWEEN) return KZ_RECEIVE_MORE;
    receiver->state = IN_FRAME;
    receiver->crc = CRC_START;
    receiver->length = 0;
  }
  length = receiver->length;
  if (length == sizeof receiver->body) {
    receiver->state = TOO_LONG;
    return KZ_RECEIVE_MORE;
  }
  place = receiver->body + length;
  *place = byte;
  receiver->length = (u8)(length + 1);
  if (length >= CHECK_SIZE) receiver->crc = kz_crc16_step(receiver->crc, place[-CHECK_SIZE]);
  return KZ_RECEIVE_MORE;
}

static void skip_rest(kz_receiver* receiver, u8 why) {
  if (receiver->state == BETWEEN || receiver->state == IN_FRAME) receiver->state = why;
}

// A byte with errors. Not inline: it is rare.
static NOT_INLINE u8 take_damaged(kz_receiver* receiver, u8 byte, u8 errors) {
  u8 result = KZ_RECEIVE_MORE;
  if (errors & KZ_RX_LOST) skip_rest(receiver, OVERRUN);
  if (errors & (KZ_RX_FRAMING | KZ_RX_PARITY)) {
    // A zero with an error (a break, for one) is damage, not a delimiter.
    skip_rest(receiver, LINE_ERROR);
  } else {
    result = take(receiver, byte);
  }
  if (errors & KZ_RX_OVERRUN) skip_rest(receiver, OVERRUN);
  return result;
}

u8 kz_receive(kz_receiver* receiver, u8 byte, u8 errors) {
  if (errors) return take_damaged(receiver, byte, errors);
  return take(receiver, byte);
}

// The next bytes of a frame, until a zero or `most` of them. Returns how many. The last three that
// came may be the check, so the CRC follows three behind.
static NOT_INLINE u8 take_run(kz_receiver* receiver, const u8* bytes, u8 most) {
  const u8 length = receiver->length;
  u8* place = receiver->body + length;
  u16 crc;
  u8 left = most;
  if (length < CHECK_SIZE) {
    u8 early = (u8)(CHECK_SIZE - length);
    for (; early != 0 && left != 0 && *bytes != 0; --early) {
      *place++ = *bytes++;
      --left;
    }
  }
  crc = receiver->crc;
  if (left != 0) {
    do {
      const u8 byte = *bytes++;
      if (byte == 0) break;
      *place = byte;
      crc = kz_crc16_step(crc, place[-CHECK_SIZE]);
      ++place;
    } while (--left != 0);
  }
  receiver->crc = crc;
  most = (u8)(most - left);
  receiver->length = (u8)(length + most);
  return most;
}

u16 kz_receive_some(kz_receiver* receiver, const u8* bytes, const u8* errors, u8 count) {
  u8 taken = 0;
  while (taken < count) {
    u8 result;
    if (receiver->state == IN_FRAME) {
      const u8 room = (u8)(sizeof receiver->body - receiver->length);
      const u8 most = (u8)(count - taken) < room ? (u8)(count - taken) : room;
      const u8* error = errors + taken;
      u8 left;
      for (left = most; left != 0; --left) {
        if (*error++ != 0) break;
      }
      taken = (u8)(taken + take_run(receiver, bytes + taken, (u8)(most - left)));
      if (taken == count) break;
    }
    result = kz_receive(receiver, bytes[taken], errors[taken]);
    ++taken;
    if (result != KZ_RECEIVE_MORE) return (u16)((u16)(result << 8) | taken);
  }
  return taken;
}

void kz_sender_init(kz_sender* sender) {
  u8 i;
  sender->crc = CRC_START;
  sender->length = 0;
  sender->next = 0;
  sender->first = 0;
  sender->stage = IDLE;
  for (i = 0; i < KZ_BODY_MAX; ++i) sender->body[i] = 0;
}

// Backwards, each zero becomes the distance to the next one, or to the end.
void kz_sender_start(kz_sender* sender, u8 body_length) {
  u8* byte = sender->body + body_length;
  u8 distance = 1;
  u8 left;
  for (left = body_length; left != 0; --left) {
    --byte;
    if (*byte == 0) {
      *byte = distance;
      distance = 1;
    } else {
      ++distance;
    }
  }
  sender->crc = CRC_START;
  sender->length = body_length;
  sender->next = 0;
  sender->first = distance;
  sender->stage = OPENING;
}

// The body, as far as there is room. Returns how many bytes.
static u8 copy_body(kz_sender* sender, u8* wire, u8 room) {
  const u8* from = sender->body + sender->next;
  const u8 rest = (u8)(sender->length - sender->next);
  const u8 count = rest < room ? rest : room;
  u16 crc = sender->crc;
  u8 left;
  for (left = count; left != 0; --left) {
    const u8 byte = *from++;
    *wire++ = byte;
    crc = kz_crc16_step(crc, byte);
  }
  sender->crc = crc;
  sender->next = (u8)(sender->next + count);
  if (count == rest) sender->stage = CHECK_HIGH;
  return count;
}

// Every byte that is not copied from the body.
static u8 other_byte(kz_sender* sender) {
  switch (sender->stage) {
    case OPENING:
      sender->stage = FIRST;
      return 0;
    case FIRST:
      sender->stage = COPYING;
      sender->crc = kz_crc16_step(sender->crc, sender->first);
      return sender->first;
    case CHECK_HIGH:
      sender->stage = CHECK_MIDDLE;
      return check_high(sender->crc);
    case CHECK_MIDDLE:
      sender->stage = CHECK_LOW;
      return check_middle(sender->crc);
    case CHECK_LOW:
      sender->stage = CLOSING;
      return check_low(sender->crc);
    default:
      sender->stage = IDLE;
      sender->length = 0;
      return 0;
  }
}

u8 kz_sender_take(kz_sender* sender, u8* wire, u8 room) {
  u8 count = 0;
  while (count < room && sender->stage != IDLE) {
    if (sender->stage == COPYING) {
      count = (u8)(count + copy_body(sender, wire + count, (u8)(room - count)));
    } else {
      wire[count++] = other_byte(sender);
    }
  }
  return count;
}
