// The host line: rings between the tick and the interrupts of SCI0.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/serial.h"

#include "firmware/copy.h"
#include "firmware/h8s2128.h"
#include "firmware/serial_rings.h"

#define BRR_115200 (KZ_STATES_PER_BIT / 32 - 1)
#define SCR_LISTENING (SCR_RIE | SCR_RE)
#define SCR_SENDING (SCR_RIE | SCR_TIE | SCR_TE | SCR_RE)

// Received bytes: `in` and `taken` count on without an end, so that the interrupt need not look
// whether there is room: what was overwritten is found when the rest is taken. A flag that is not 0
// stands beside a byte only while `damaged`. With the sender's, below, the variables that
// serial_interrupts.S knows.
volatile u8 kz_received_byte[KZ_RING];
volatile u8 kz_received_in;
static volatile u8 flag[KZ_RING];
static volatile u8 damaged;
static u8 taken;
static u8 flags_given;  // the last snapshot has flags that are not 0

// More than that waiting, 4 ms of the line: the tick was kept away, and what is old may be gone.
#define WAITING_MAX (KZ_RING - KZ_RX_PER_TICK)

// `in` is only moved by who fills the ring, `out` only by who empties it.
volatile u8 kz_queued_byte[KZ_RING];
volatile u8 kz_queued_in;
volatile u8 kz_queued_out;

// SCR once the last byte is on its way. On a shared line the end of it is awaited, and the transmitter
// switched off; else it stays on.
u8 kz_scr_last_byte;

void kz_serial_init(u8 shared_line) {
  u8 wait;
  SCI0_SCR = 0;
  SCI0_SMR = 0;
  SCI0_BRR = BRR_115200;
  for (wait = 0; wait < KZ_STATES_PER_BIT; ++wait) (void)SCI0_SSR;  // longer than one bit
  SCI0_SCR = shared_line ? SCR_LISTENING : SCR_LISTENING | SCR_TE;
  kz_scr_last_byte = SCR_LISTENING | SCR_TE;
  if (shared_line) kz_scr_last_byte |= SCR_TEIE;
}

u8 kz_serial_idle(void) {
  return (u8)(kz_queued_out == kz_queued_in && (SCI0_SSR & SSR_TEND));
}

void kz_serial_send(const u8* bytes, u8 count) {
  u8 in = kz_queued_in;
  const u8 to_end = (u8)(KZ_RING - in);
  if (count == 0) return;
  if (count >= to_end) {
    kz_copy((u8*)kz_queued_byte + in, bytes, to_end);
    bytes += to_end;
    count = (u8)(count - to_end);
    in = 0;
  }
  if (count != 0) kz_copy((u8*)kz_queued_byte + in, bytes, count);
  in = (u8)(in + count);
  // The interrupt counts on a byte being there.
  KZ_INTERRUPTS_OFF();
  kz_queued_in = in;
  SCI0_SCR = SCR_SENDING;
  KZ_INTERRUPTS_ON();
}

u8 kz_serial_room(void) {
  return (u8)((kz_queued_out - kz_queued_in - 1) & (KZ_RING - 1));
}

static void take_flags(u8* flags, u8 from, u8 count) {
  for (; from != taken; ++from) {
    *flags++ = flag[from & (KZ_RING - 1)];
    flag[from & (KZ_RING - 1)] = 0;
    --count;
  }
  for (; count != 0; --count) *flags++ = 0;
  KZ_INTERRUPTS_OFF();
  if (taken == kz_received_in) damaged = 0;
  KZ_INTERRUPTS_ON();
}

void kz_serial_take(kz_tick_input* input) {
  u8* byte = input->rx;
  u8 out = taken;
  u8 left = (u8)(kz_received_in - out);
  u8 lost = 0;
  if (left > WAITING_MAX) {
    out = (u8)(out + left - KZ_RX_PER_TICK);
    left = KZ_RX_PER_TICK;
    lost = KZ_RX_LOST;
    damaged = 1;
  }
  if (left > KZ_RX_PER_TICK) left = KZ_RX_PER_TICK;
  input->rx_count = left;
  taken = (u8)(out + left);
  if (left != 0) {
    const u8 from = out & (KZ_RING - 1);
    const u8 to_end = (u8)(KZ_RING - from);
    if (left > to_end) {
      kz_copy(byte, (u8*)kz_received_byte + from, to_end);
      byte += to_end;
      kz_copy(byte, (u8*)kz_received_byte, (u8)(left - to_end));
    } else {
      kz_copy(byte, (u8*)kz_received_byte + from, left);
    }
  }
  if ((damaged | lost | flags_given) != 0) {
    const u8 more = (u8)(damaged | lost);  // then the next snapshot has to clear these
    take_flags(input->rx_flags, (u8)(taken - input->rx_count), KZ_RX_PER_TICK);
    input->rx_flags[0] |= lost;
    flags_given = more;
  }
}

// After an overrun the byte in RDR is the last valid one; after the other errors it is the damaged one.
KZ_INTERRUPT void kz_serial_receive_error(void) {
  const u8 flags = (u8)(SCI0_SSR & (SSR_ORER | SSR_FER | SSR_PER));
  const u8 in = kz_received_in;
  kz_received_byte[in & (KZ_RING - 1)] = SCI0_RDR;
  flag[in & (KZ_RING - 1)] = flags;
  damaged = 1;
  SCI0_SSR &= (u8) ~(SSR_ORER | SSR_FER | SSR_PER | SSR_RDRF);
  kz_received_in = (u8)(in + 1);
}

// Only on a shared line.
KZ_INTERRUPT void kz_serial_transmitted(void) {
  SCI0_SCR = kz_queued_out == kz_queued_in ? SCR_LISTENING : SCR_SENDING;
}
