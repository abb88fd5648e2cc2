// The host line: rings between the tick and the interrupts of SCI0.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/serial.h"

#include "firmware/h8s2128.h"

#define RING 64  // a power of two; one place stays empty
#define NEXT(place) ((u8)(((place) + 1) & (RING - 1)))
#define BRR_115200 (KZ_STATES_PER_BIT / 32 - 1)
#define SCR_LISTENING (SCR_RIE | SCR_RE)
#define SCR_SENDING (SCR_RIE | SCR_TIE | SCR_TE | SCR_RE)

// `in` is only moved by who fills the ring, `out` only by who empties it.
static volatile struct {
  u16 entry[RING];  // error flags, byte
  u8 in;
  u8 out;
} received;
static volatile u8 lost;

static volatile struct {
  u8 byte[RING];
  u8 in;
  u8 out;
} queued;

// SCR once the last byte is in the shift register. On a shared line the end of it is awaited, and the
// transmitter switched off; else it stays on.
static u8 scr_last_byte;

void kz_serial_init(u8 shared_line) {
  u8 wait;
  SCI0_SCR = 0;
  SCI0_SMR = 0;
  SCI0_BRR = BRR_115200;
  for (wait = 0; wait < KZ_STATES_PER_BIT; ++wait) (void)SCI0_SSR;  // longer than one bit
  SCI0_SCR = shared_line ? SCR_LISTENING : SCR_LISTENING | SCR_TE;
  scr_last_byte = SCR_LISTENING | SCR_TE;
  if (shared_line) scr_last_byte |= SCR_TEIE;
}

u8 kz_serial_idle(void) {
  return (u8)(queued.out == queued.in && (SCI0_SSR & SSR_TEND));
}

void kz_serial_send(const u8* bytes, u8 count) {
  u8 in = queued.in;
  if (count == 0) return;
  for (; count != 0; --count) {
    queued.byte[in] = *bytes++;
    in = NEXT(in);
  }
  queued.in = in;
  SCI0_SCR = SCR_SENDING;
}

u8 kz_serial_room(void) {
  return (u8)((queued.out - queued.in - 1) & (RING - 1));
}

void kz_serial_take(kz_tick_input* input) {
  u8* byte = input->rx;
  u8* flags = input->rx_flags;
  const u8 in = received.in;
  u8 out = received.out;
  u8 count = 0;
  while (out != in && count < KZ_RX_PER_TICK) {
    const u16 entry = received.entry[out];
    *byte++ = (u8)entry;
    *flags++ = (u8)(entry >> 8);
    out = NEXT(out);
    ++count;
  }
  received.out = out;
  input->rx_count = count;
}

static inline void keep(u16 entry) {
  const u8 in = received.in;
  const u8 next = NEXT(in);
  if (next == received.out) {
    lost = 1;
    return;
  }
  if (lost) {
    lost = 0;
    entry |= KZ_RX_LOST << 8;
  }
  received.entry[in] = entry;
  received.in = next;
}

KZ_INTERRUPT void kz_serial_received(void) {
  const u8 byte = SCI0_RDR;
  SCI0_SSR &= (u8)~SSR_RDRF;  // reads the flag as 1, then writes 0: the chip wants both
  keep(byte);
}

// After an overrun the byte in RDR is the last sound one; after the others it is the damaged one.
KZ_INTERRUPT void kz_serial_receive_error(void) {
  const u8 flags = (u8)(SCI0_SSR & (SSR_ORER | SSR_FER | SSR_PER));
  const u8 byte = SCI0_RDR;
  SCI0_SSR &= (u8) ~(SSR_ORER | SSR_FER | SSR_PER | SSR_RDRF);
  keep((u16)((u16)flags << 8 | byte));
}

KZ_INTERRUPT void kz_serial_transmit(void) {
  const u8 out = queued.out;
  if (out == queued.in) {
    SCI0_SCR = scr_last_byte;
    return;
  }
  SCI0_TDR = queued.byte[out];
  SCI0_SSR &= (u8)~SSR_TDRE;
  queued.out = NEXT(out);
}

// Only on a shared line.
KZ_INTERRUPT void kz_serial_transmitted(void) {
  SCI0_SCR = queued.out == queued.in ? SCR_LISTENING : SCR_SENDING;
}
