// Frames: the bytes between two zero bytes on the wire.
// SPDX-License-Identifier: Apache-2.0
//
//   00 | stuffed body | check (3 bytes) | 00
//
//   body     address, type, sequence number, then the fields of the message (messages.def),
//            big-endian
//   stuffed  consistent overhead byte stuffing (COBS, Cheshire and Baker 1999): no zero inside
//   check    CRC-16 (polynomial 0x1021, start 0xFFFF, most significant bit first) over the stuffed
//            bytes, as they are on the wire; in 7-bit groups 0x80|crc>>14, 0x80|crc>>7&0x7f,
//            0x80|crc&0x7f, so that it holds no zero either
//
// Each frame has a zero of its own at both ends. A receiver that joins in the middle, or loses or
// gains bytes, is right again at the next zero. Of one damaged byte:
//   - inside, and no zero: a burst of at most 8 bits in what the CRC covers, or a wrong check;
//   - a zero that was damaged: in front, no byte leaves the CRC's start as it is; behind, the first
//     byte of the check would have to be a stuffing byte, but those are below 0x80;
//   - inside, and now a zero: the part before it fails for the same reason; the part behind it
//     has the right check only if kz_frame_splits.
#ifndef KAZ_SHARED_PROTOCOL_FRAME_H
#define KAZ_SHARED_PROTOCOL_FRAME_H

#include "shared/base/types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_HEADER_SIZE 3  // address, type, sequence number: bytes 0, 1, 2 of a body
#define KZ_BODY_ADDRESS 0
#define KZ_BODY_TYPE 1
#define KZ_BODY_SEQUENCE 2
#define KZ_IDLE_MS 20      // a frame in which no byte comes for so long is given up
#define KZ_PAYLOAD_MAX 96  // bytes of fields in one message
#define KZ_BODY_MAX (KZ_HEADER_SIZE + KZ_PAYLOAD_MAX)
// Longest frame: two zeros, one stuffing byte, the body, the check. A body is shorter than 254
// bytes, so one stuffing byte is all that COBS adds.
#define KZ_FRAME_MAX (2 + 1 + KZ_BODY_MAX + 3)

u16 kz_crc16(u16 crc, u8 byte);

// What became of a received byte. Of several kinds of damage in one frame the first one counts.
#define KZ_RECEIVE_MORE 0          // nothing complete yet
#define KZ_RECEIVE_FRAME 1         // a valid frame ended: body[0..length-1]
#define KZ_RECEIVE_BAD_CHECK 2     // a frame ended whose check is wrong
#define KZ_RECEIVE_BAD_STUFFING 3  // a frame ended in the middle of a stuffed block
#define KZ_RECEIVE_TOO_SHORT 4
#define KZ_RECEIVE_TOO_LONG 5
#define KZ_RECEIVE_LINE_ERROR 6  // a byte of the frame had a framing or parity error
#define KZ_RECEIVE_OVERRUN 7     // bytes of the frame were lost on this side of the wire
#define KZ_RECEIVE_IDLE 8        // no byte came for KZ_IDLE_MS in the middle of the frame

// Errors of a received byte, as the SCI reports them.
#define KZ_RX_OVERRUN 0x20  // the byte is valid, those after it are lost
#define KZ_RX_FRAMING 0x10
#define KZ_RX_PARITY 0x08
#define KZ_RX_LOST 0x04  // the byte is valid, those before it are lost: the receive buffer was full

#define KZ_RECEIVER_BETWEEN 1

// Takes bytes as they come: a few instructions for each, and one pass over the frame at its end.
// Owns its buffer; no length from the wire is ever trusted.
typedef struct kz_receiver {
  u16 crc;    // of all bytes of the frame but the last three, which may be its check
  u8 length;  // bytes of the frame so far; of the body once KZ_RECEIVE_FRAME has come
  u8 state;   // up to KZ_RECEIVER_BETWEEN: no frame has begun
  u8 body[KZ_BODY_MAX + 4];  // while it comes: stuffed, and with its check
  u8 silent_ms;              // since the last byte; whoever calls kz_receiver_silent sets it to 0
} kz_receiver;

void kz_receiver_init(kz_receiver* receiver);
// `errors`: KZ_RX_* flags of the byte, 0 if it is valid.
u8 kz_receive(kz_receiver* receiver, u8 byte, u8 errors);
// Takes bytes up to the first one with a result other than KZ_RECEIVE_MORE, or all of them. In the
// lower byte of what it returns: how many it took; in the upper byte: the result of the last.
u16 kz_receive_some(kz_receiver* receiver, const u8* bytes, const u8* errors, u8 count);
// A millisecond in which no byte came. After KZ_IDLE_MS of them in a row a frame that has begun is
// given up: the result is KZ_RECEIVE_IDLE, or what was wrong with the frame before; else
// KZ_RECEIVE_MORE. The caller sets silent_ms to 0 when bytes come, once for all of them.
// (kz_receiver_waited is the part of it inside a frame.)
u8 kz_receiver_waited(kz_receiver* receiver);
static inline u8 kz_receiver_silent(kz_receiver* receiver) {
  return receiver->state > KZ_RECEIVER_BETWEEN ? kz_receiver_waited(receiver) : KZ_RECEIVE_MORE;
}

// Encodes a whole frame, both zeros included. `body_length` <= KZ_BODY_MAX; `wire` holds
// KZ_FRAME_MAX. Returns the number of bytes written.
u8 kz_frame_encode(const u8* body, u8 body_length, u8* wire);

// 1 if the CRC returns to its start value within the frame, as it does in about one of 1500 frames:
// one damaged byte that became a zero would then leave a remainder whose check is right. A sender that
// takes another sequence number in this case makes frames of which no damage to one byte is accepted.
u8 kz_frame_splits(const u8* wire, u8 length);

// Encodes a frame piece by piece, so that a tick never sends more than its share.
typedef struct kz_sender {
  u16 crc;
  u8 length;  // of body, 0 if nothing is being sent
  u8 next;    // next byte of body
  u8 first;   // the stuffing byte before the body
  u8 stage;
  u8 body[KZ_BODY_MAX];  // stuffed in place by kz_sender_start
} kz_sender;

void kz_sender_init(kz_sender* sender);
static inline u8 kz_sender_busy(const kz_sender* sender) {
  return (u8)(sender->length != 0);
}
// The caller has filled sender->body[0..body_length-1]; sending starts.
void kz_sender_start(kz_sender* sender, u8 body_length);
// Writes at most `room` bytes of the frame to `wire`, returns how many.
u8 kz_sender_take(kz_sender* sender, u8* wire, u8 room);

#ifdef __cplusplus
}
#endif

#endif
