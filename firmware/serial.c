// The host line: rings between the tick and the interrupts of SCI0.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/serial.h"

#include "firmware/h8s2128.h"

#define RING 64  // a power of two; one place stays empty
#define NEXT(place) ((u8)(((place) + 1) & (RING - 1)))
#define BRR_115200 (KZ_STATES_PER_BIT / 32 - 1)
#define SCR_LISTENING (SCR_RIE | SCR_RE)
#define SCR_SENDING (SCR_RIE | SCR_TIE | SCR_TE | SCR_RE)

// Received bytes: `in` and `taken` count on without an end, so that the interrupt need not look
// whether there is room: what was overwritten is found when the rest is taken. A flag that is not 0
// stands beside a byte only while `damaged`.
static volatile struct {
  u8 byte[RING];
  u8 flag[RING];
  u8 in;
  u8 damaged;
} received;
static u8 taken;
static u8 flags_given;  // the last snapshot has flags that are not 0

// More than that waiting, 4 ms of the line: the tick was kept away, and what is old may be gone.
#define WAITING_MAX (RING - KZ_RX_PER_TICK)

// `in` is only moved by who fills the ring, `out` only by who empties it.
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

static void take_flags(u8* flags, u8 from, u8 count) {
  for (; from != taken; ++from) {
    *flags++ = received.flag[from & (RING - 1)];
    received.flag[from & (RING - 1)] = 0;
    --count;
  }
  for (; count != 0; --count) *flags++ = 0;
  KZ_INTERRUPTS_OFF();
  if (taken == received.in) received.damaged = 0;
  KZ_INTERRUPTS_ON();
}

void kz_serial_take(kz_tick_input* input) {
  u8* byte = input->rx;
  u8 out = taken;
  u8 left = (u8)(received.in - out);
  u8 lost = 0;
  if (left > WAITING_MAX) {
    out = (u8)(out + left - KZ_RX_PER_TICK);
    left = KZ_RX_PER_TICK;
    lost = KZ_RX_LOST;
    received.damaged = 1;
  }
  if (left > KZ_RX_PER_TICK) left = KZ_RX_PER_TICK;
  input->rx_count = left;
  taken = (u8)(out + left);
  for (; left != 0; --left) {
    *byte++ = received.byte[out & (RING - 1)];
    ++out;
  }
  if ((received.damaged | lost | flags_given) != 0) {
    const u8 more = (u8)(received.damaged | lost);  // then the next snapshot has to clear these
    take_flags(input->rx_flags, (u8)(taken - input->rx_count), KZ_RX_PER_TICK);
    input->rx_flags[0] |= lost;
    flags_given = more;
  }
}

KZ_INTERRUPT void kz_serial_received(void) {
  const u8 in = received.in;
  received.byte[in & (RING - 1)] = SCI0_RDR;
  SCI0_SSR &= (u8)~SSR_RDRF;  // reads the flag as 1, then writes 0: the chip wants both
  received.in = (u8)(in + 1);
}

// After an overrun the byte in RDR is the last sound one; after the others it is the damaged one.
KZ_INTERRUPT void kz_serial_receive_error(void) {
  const u8 flags = (u8)(SCI0_SSR & (SSR_ORER | SSR_FER | SSR_PER));
  const u8 in = received.in;
  received.byte[in & (RING - 1)] = SCI0_RDR;
  received.flag[in & (RING - 1)] = flags;
  received.damaged = 1;
  SCI0_SSR &= (u8) ~(SSR_ORER | SSR_FER | SSR_PER | SSR_RDRF);
  received.in = (u8)(in + 1);
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
