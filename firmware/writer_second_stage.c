// The part of the flash writer that does not go through boot mode: erasing, sums, reading, leaving.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/h8s2128.h"
#include "firmware/writer.h"

#define LOADER_BLOCK 6
#define ERASE_PULSES 230
// Overflows of the timer, 28.4 ms each.
#define PER_SECOND 35
#define SESSION 350  // 10 s; started by the loader, it leaves where no host talks for so long

static const u32 block_start[KZ_WRITER_BLOCKS + 1] = {
    0x0000, 0x0400, 0x0800, 0x0c00, 0x1000, 0x8000, 0xc000, 0xe000, 0x10000, 0x18000, 0x20000};

u16 kz_writer_silent NEAR;
static u16 patience NEAR;  // overflows; 0: without end

static u8 erased(u8 block) {
  volatile u16* at = (volatile u16*)block_start[block];
  volatile u16* const last = (volatile u16*)block_start[block + 1];
  u8 all = 1;
  kz_writer_set_flash(FLMCR1_EV);
  while (at != last) {
    kz_writer_poll();
    if (kz_writer_verified_word(at) != 0xFFFF) {
      all = 0;
      break;
    }
    ++at;
  }
  kz_writer_set_flash(0);
  return all;
}

static u8 erase(u8 block) {
  u8 status = KZ_WRITER_NOT_ERASED;
  u8 left = ERASE_PULSES;
  if (block >= KZ_WRITER_BLOCKS) return KZ_WRITER_ARGUMENTS;
  if (kz_writer_by_loader && (block == 0 || block == LOADER_BLOCK)) return KZ_WRITER_PROTECTED;
  kz_writer_set_flash(0);
  if (erased(block)) return kz_writer_end_flash(KZ_WRITER_OK);
  while (left != 0 && status != KZ_WRITER_OK) {
    --left;
    EBR1 = (u8)(block >= 8 ? 1 << (block - 8) : 0);
    EBR2 = (u8)(block >= 8 ? 0 : 1 << block);
    kz_writer_pulse(FLMCR2_ESU, KZ_COUNTS(200), FLMCR1_E, KZ_COUNTS(5100));
    if (FLMCR2 & FLMCR2_FLER) break;
    if (erased(block)) status = KZ_WRITER_OK;
  }
  EBR1 = 0;
  EBR2 = 0;
  return kz_writer_end_flash(status);
}

// Ends at the flash's end.
static void sum(u16* to, const volatile u8* from, u32 bytes) {
  u16 plain = 0, sums = 0;
  kz_writer_crc = 0xFFFF;
  while (bytes-- != 0 && (u32)from != KZ_FLASH_BYTES) {
    const u8 byte = *from++;
    kz_writer_count(byte);
    plain = (u16)(plain + byte);
    sums = (u16)(sums + plain);
  }
  to[0] = kz_writer_crc;
  to[1] = plain;
  to[2] = sums;
}

// Everything that was touched goes back to what reset makes of it.
static void leave(void) {
  SCI0_SCR = 0;
  FRT_TCR = 0;
  STCR = 0;
  P5DDR = 0;
  P5DR = 0;
  MSTPCRH = MSTPCRH_RESET;
  MSTPCRL = MSTPCRL_RESET;
  kz_writer_leave();
}

void kz_writer_perform(frame* it) {
  const u8 type = it->type;
  u32* const address = (u32*)it->payload;
  u16* const more = (u16*)it->payload + 1;  // behind the status
  // A shorter payload would be read past its end, into what an earlier frame has left there.
  const u16 length = it->length;
  u8 status = KZ_WRITER_ARGUMENTS;
  u16 bytes = 2;
  if (type == KZ_WRITER_ERASE) {
    if (length == 1) status = erase(it->payload[0]);
  } else if (type == KZ_WRITER_SUM) {
    if (length == 8 && address[0] < KZ_FLASH_BYTES) {
      sum(more, (const u8*)address[0], address[1]);
      status = KZ_WRITER_OK;
      bytes = 8;
    }
  } else if (type == KZ_WRITER_READ) {
    const volatile u8* from = (const u8*)address[0];
    u16 left = *(u16*)(address + 1);
    u8* to = (u8*)more;
    if (length == 6 && left <= KZ_WRITER_DATA_MAX && (u32)from <= KZ_FLASH_BYTES - left) {
      status = KZ_WRITER_OK;
      bytes = (u16)(left + 2);
      for (; left != 0; --left) *to++ = *from++;
    }
  } else if (type == KZ_WRITER_RUN) {
    status = *(const volatile u16*)0UL == 0xFFFF ? KZ_WRITER_NOTHING : KZ_WRITER_OK;
  } else {
    status = KZ_WRITER_UNKNOWN;
  }
  it->payload[0] = status;
  kz_writer_reply(it, bytes);
  if (type == KZ_WRITER_RUN && status == KZ_WRITER_OK) leave();
}

void kz_writer_wait_for(u16 seconds) {
  kz_writer_silent = 0;
  patience = (u16)(seconds * PER_SECOND);
}

void kz_writer_idle(void) {
  if (!(FRT_TCSR & FRT_TCSR_OVF)) return;
  FRT_TCSR &= (u8)~FRT_TCSR_OVF;
  ++kz_writer_silent;
  if (!kz_writer_by_loader) return;
  if (kz_writer_heard) patience = SESSION;
  if (patience != 0 && kz_writer_silent >= patience) leave();
}
