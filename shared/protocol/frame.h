// Frames of the wire protocol: encoder, and a decoder that detects damage.
// SPDX-License-Identifier: Apache-2.0
//
//   00 | stuffed body | check (3 bytes) | 00
//
//   body     address, type, sequence number, then the fields of the message (messages.def),
//            big-endian
//   stuffed  consistent overhead byte stuffing (COBS, Cheshire and Baker 1999): no zero inside
//   check    CRC-16 (polynomial 0x1021, start 0xFFFF, most significant bit first) of the stuffed bytes,
//            in 7-bit groups without zeros: 0x80|crc>>14, 0x80|crc>>7&0x7f, 0x80|crc&0x7f
//
// Each frame begins with a zero byte and ends with a zero byte. Two frames never share a zero. If a receiver
// starts within a frame, loses bytes or gets extra bytes, the next zero synchronizes the receiver.
//
// One damaged byte is always detected, with one exception (kz_frame_splits). The cases are:
//   - Between the two zeros, a byte changes to a nonzero value. If the byte belongs to the check, the check
//     no longer agrees with the CRC. If the byte is before the check, all wrong bits lie within 8 adjacent
//     bits. A CRC-16 always detects wrong bits within 8 adjacent bits.
//   - The first zero changes. The receiver then includes the damaged byte in its CRC. Each possible value of
//     this byte changes the CRC, so the check is wrong.
//   - The last zero changes. The receiver then takes the first byte of the check for a stuffing byte.
//     Stuffing bytes are below 0x80, but bytes of a check are not, so the receiver rejects the frame.
//   - Between the two zeros, a byte changes to zero. The frame is then split into two parts. The receiver
//     treats the last three bytes of the first part as a check. The first byte of a valid check is at least
//     0x80. If the first of the three bytes is a stuffing byte, this byte is below 0x80, so the check is
//     wrong. If the first of the three bytes is not a stuffing byte, the stuffed block before the three bytes
//     is incomplete. In both cases, the receiver rejects the first part. The check of the second part is
//     valid only if kz_frame_splits returns 1.
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
#define KZ_IDLE_MS 20      // timeout between two bytes of a frame
#define KZ_PAYLOAD_MAX 96  // maximum size of the fields of a message, bytes
#define KZ_BODY_MAX (KZ_HEADER_SIZE + KZ_PAYLOAD_MAX)
// Longest frame: two zeros, one stuffing byte, body and check. COBS adds only one byte because a body is
// shorter than 254 bytes.
#define KZ_FRAME_MAX (2 + 1 + KZ_BODY_MAX + 3)

// Returns the CRC after one more byte; `crc` is the CRC before this byte. The start value is 0xFFFF.
u16 kz_crc16(u16 crc, u8 byte);

// Result of a received byte. If a frame is damaged in several ways, the result is the first damage that was
// found.
#define KZ_RECEIVE_MORE 0          // no frame ended
#define KZ_RECEIVE_FRAME 1         // a valid frame ended; its body is body[0..length-1]
#define KZ_RECEIVE_BAD_CHECK 2     // a frame with a wrong check ended
#define KZ_RECEIVE_BAD_STUFFING 3  // a frame ended in the middle of a stuffed block
#define KZ_RECEIVE_TOO_SHORT 4
#define KZ_RECEIVE_TOO_LONG 5
#define KZ_RECEIVE_LINE_ERROR 6  // a byte of the frame had a framing or parity error
#define KZ_RECEIVE_OVERRUN 7     // the receiving side lost bytes of the frame
#define KZ_RECEIVE_IDLE 8        // no byte for KZ_IDLE_MS within the frame

// Errors of a received byte, as the SCI reports them.
#define KZ_RX_OVERRUN 0x20  // the byte is valid, but later bytes were lost
#define KZ_RX_FRAMING 0x10
#define KZ_RX_PARITY 0x08
#define KZ_RX_LOST 0x04  // the byte is valid, but earlier bytes were lost (receive buffer full)

#define KZ_RECEIVER_BETWEEN 1  // state between frames

// Frame decoder. Each byte takes only a few instructions. At the end of a frame, the decoder goes through the
// whole frame once more. The struct contains the buffer. The decoder checks all lengths from the wire.
typedef struct kz_receiver {
  u16 crc;    // CRC of the frame's bytes except the last three, which may be the check
  u8 length;  // number of received bytes; after KZ_RECEIVE_FRAME, size of the body
  u8 state;   // above KZ_RECEIVER_BETWEEN: a frame has begun; otherwise: no frame has begun
  u8 body[KZ_BODY_MAX + 4];  // body; during reception, the stuffed bytes and the check
  u8 silent_ms;  // time without a byte, ms; if bytes arrive, the caller sets silent_ms to 0
} kz_receiver;

void kz_receiver_init(kz_receiver* receiver);
// Processes one byte and returns KZ_RECEIVE_*. `errors` has the KZ_RX_* flags of the byte; 0: the byte is
// valid. The received body stays valid until the next byte.
u8 kz_receive(kz_receiver* receiver, u8 byte, u8 errors);
// Processes up to `count` bytes, and stops after a byte with a result other than KZ_RECEIVE_MORE. Returns
// the result of the last processed byte in the upper byte, and the number of processed bytes in the lower
// byte.
u16 kz_receive_some(kz_receiver* receiver, const u8* bytes, const u8* errors, u8 count);
// Internal: kz_receiver_silent calls this function if a frame has begun.
u8 kz_receiver_waited(kz_receiver* receiver);
// Call kz_receiver_silent for each millisecond without a byte. If bytes arrive, the caller must set silent_ms
// to 0. If a frame has begun and no byte arrives for KZ_IDLE_MS milliseconds, the function drops the frame
// and returns KZ_RECEIVE_IDLE. If the dropped frame was already invalid (too long, or with a damaged or lost
// byte), the function returns the code of this error instead of KZ_RECEIVE_IDLE. In all other cases, the
// function returns KZ_RECEIVE_MORE.
static inline u8 kz_receiver_silent(kz_receiver* receiver) {
  return receiver->state > KZ_RECEIVER_BETWEEN ? kz_receiver_waited(receiver) : KZ_RECEIVE_MORE;
}

// Encodes a whole frame, including both zeros. `body_length` is at most KZ_BODY_MAX; `wire` has room for
// KZ_FRAME_MAX bytes. Returns the number of bytes written.
u8 kz_frame_encode(const u8* body, u8 body_length, u8* wire);

// A stuffed byte is critical if the CRC after this byte is 0xFFFF, the start value of the CRC. If damage
// changes a critical byte to zero, the rest of the frame has a valid check. About one of 1500 frames has a
// critical byte. kz_frame_splits returns 1 if the frame has a critical byte, and 0 if not. If the result is
// 1, the sender should encode the message again, with another sequence number.
u8 kz_frame_splits(const u8* wire, u8 length);

// Frame encoder that works in pieces. Each call of kz_sender_take encodes the next bytes of the frame.
typedef struct kz_sender {
  u16 crc;
  u8 length;  // size of the body, bytes; 0: idle
  u8 next;    // index of the next byte of the body
  u8 first;   // the stuffing byte before the body
  u8 stage;
  u8 body[KZ_BODY_MAX];  // stuffed in place by kz_sender_start
} kz_sender;

void kz_sender_init(kz_sender* sender);
// Returns 1 while a frame is being sent.
static inline u8 kz_sender_busy(const kz_sender* sender) {
  return (u8)(sender->length != 0);
}
// Starts to encode a frame. Before the call, the caller must write the frame's body to
// sender->body[0..body_length-1]. The sender must be idle.
void kz_sender_start(kz_sender* sender, u8 body_length);
// Writes up to `room` further bytes of the frame to `wire`. Returns the number of bytes written.
u8 kz_sender_take(kz_sender* sender, u8* wire, u8 room);

#ifdef __cplusplus
}
#endif

#endif
