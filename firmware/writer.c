// The flash writer's line: bytes into two frames that take turns, requests, replies.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/writer.h"

#include "firmware/h8s2128.h"
#include "shared/flash/protocol.h"

#define RAM_PAGE 0x00FF           // upper half of the addresses of RAM
#define SILENCE KZ_COUNTS(20000)  // a frame does not go on: what came of it is thrown away

static frame frames[2] NEAR;
static frame* receiving NEAR;
static u8* in NEAR;       // next byte of `receiving`
static u8* in_end NEAR;   // header or frame is whole there; equal to `in`: nothing is received
static frame* work NEAR;  // whole, not done yet
static u16 last_byte NEAR;
static u16* filled NEAR;  // the program is there up to here
static u16 board NEAR;
u16 kz_writer_crc NEAR;
static volatile u8 next_is_whole SHORT;
static volatile u8 damaged SHORT;
volatile u8 kz_writer_by_loader SHORT;
volatile u8 kz_writer_heard SHORT;
static volatile u8 rest_is_there SHORT;

static void receive_into(frame* to) {
  receiving = to;
  in = (u8*)to;
  in_end = to->payload;
}

static frame* other(frame* one) {
  return one == frames ? frames + 1 : frames;
}

// The frame in `work` is done; one that was received meanwhile takes its place.
static void end_work(void) {
  work = 0;
  if (!next_is_whole) return;
  next_is_whole = 0;
  work = receiving;
  receive_into(other(work));
}

// The header is there, or the frame.
static void piece_is_whole(void) {
  frame* const now = receiving;
  if (in == now->payload) {
    const u8* byte = (const u8*)now;
    if (now->length > KZ_WRITER_PAYLOAD_MAX ||
        (u8)(byte[1] + byte[2] + byte[3] + byte[4] + byte[5]) != 0xFF) {
      damaged = 1;
    } else {
      in_end = in + now->length + 2;
    }
  } else if (work == 0) {
    work = now;
    receive_into(other(now));
  } else {
    next_is_whole = 1;
  }
}

void kz_writer_poll(void) {
  const u8 flags = SCI0_SSR;
  u8 byte;
  if (!(flags & (SSR_RDRF | SSR_ORER | SSR_FER | SSR_PER))) return;
  byte = SCI0_RDR;
  SCI0_SSR = (u8)(flags & ~(SSR_RDRF | SSR_ORER | SSR_FER | SSR_PER));
  last_byte = FRT_FRC;
  if (!(flags & SSR_RDRF) || in == in_end) return;
  if (in == (u8*)receiving && byte != KZ_WRITER_SYNC) return;
  *in++ = byte;
  if (in == in_end) piece_is_whole();
}

void kz_writer_wait(u16 counts) {
  const u16 from = FRT_FRC;
  do {
    kz_writer_poll();
  } while ((u16)(FRT_FRC - from) < counts);
}

// The CRC's polynomial is 0x1021: a byte at once without a table.
void kz_writer_count(u8 byte) {
  u16 wide = (u16)((kz_writer_crc >> 8) ^ byte);
  wide ^= (u16)(wide >> 4);
  kz_writer_crc = (u16)((u16)(kz_writer_crc << 8) ^ (u16)(wide << 12) ^ (u16)(wide << 5) ^ wide);
  kz_writer_poll();
}

static void put(u8 byte) {
  while (!(SCI0_SSR & SSR_TDRE)) kz_writer_poll();
  SCI0_TDR = byte;
  SCI0_SSR &= (u8)~SSR_TDRE;
  kz_writer_count(byte);
}

// The request becomes the reply: `bytes` of payload, the status among them. The transmitter is on only
// while it sends: on a shared line TxD floats otherwise.
void kz_writer_reply(frame* it, u16 bytes) {
  const u8* next = &it->type;
  u16 sent;
  it->type |= KZ_WRITER_REPLY;
  it->length = bytes;
  it->check = (u8) ~(it->type + (u8)(bytes >> 8) + (u8)bytes + it->number);
  bytes = (u16)(bytes + KZ_WRITER_HEADER - 1);
  SCI0_SCR = SCR_TE | SCR_RE;
  put(KZ_WRITER_SYNC);
  kz_writer_crc = 0xFFFF;
  do {
    put(*next++);
  } while (--bytes != 0);
  sent = kz_writer_crc;
  put((u8)(sent >> 8));
  put((u8)sent);
  while (!(SCI0_SSR & SSR_TEND)) kz_writer_poll();
  SCI0_SCR = SCR_RE;
}

// For a writer that the loader started.
static u8 is_protected(u16 high, u16 low) {
  return (u8)(kz_writer_by_loader && high == 0 && (low < 0x400 || (low & 0xE000) == 0xC000));
}

// writer.ld
extern u16 kz_writer_rest_start[];
extern u16 kz_writer_program_end[];

// Stores more of the second stage. A word below `filled` is compared and never stored: the host may
// repeat a frame whose reply was lost, and code that may run already cannot be changed.
static u8 write_ram(u16* to, const u16* data, u16 bytes) {
  if (kz_writer_by_loader || to < kz_writer_rest_start ||
      (u16*)((u8*)to + bytes) > kz_writer_program_end)
    return KZ_WRITER_PROTECTED;
  if (to > filled) return KZ_WRITER_ARGUMENTS;
  for (; bytes != 0; bytes = (u16)(bytes - 2)) {
    if (to == filled) {
      *to = *data;
      ++filled;
    } else if (*to != *data) {
      return KZ_WRITER_PROTECTED;
    }
    ++to;
    ++data;
    kz_writer_poll();
  }
  rest_is_there = (u8)(filled == kz_writer_program_end);
  return KZ_WRITER_OK;
}

// `*at` ends at the line that failed. A payload without a whole address has wrapped to `bytes` that are
// no multiple of a line.
static u8 write(u32* at, const u16* data, u16 bytes) {
  u8 status = KZ_WRITER_OK;
  if ((u8)((u8)*at | (u8)bytes) % KZ_WRITER_LINE != 0) return KZ_WRITER_ARGUMENTS;
  if (((u16*)at)[0] == RAM_PAGE) return write_ram((u16*)*at, data, bytes);
  if (*at > KZ_FLASH_BYTES - bytes) return KZ_WRITER_ARGUMENTS;
  for (; bytes != 0; bytes = (u16)(bytes - KZ_WRITER_LINE)) {
    if (is_protected(((u16*)at)[0], ((u16*)at)[1])) return KZ_WRITER_PROTECTED;
    status = kz_writer_program(*at, data);
    if (status != KZ_WRITER_OK) break;
    *at += KZ_WRITER_LINE;
    data += KZ_WRITER_LINE / 2;
  }
  return status;
}

static void kz_writer_rate(u8 brr) {
  SCI0_SCR = 0;
  SCI0_BRR = brr;
  kz_writer_wait(KZ_COUNTS(220));  // longer than a bit at 4,800 baud, KZ_WRITER_BRR_MAX
  SCI0_SCR = SCR_RE;
}

static void perform(frame* it) {
  const u8 type = it->type;
  u32* const address = (u32*)it->payload;
  u16* const more = (u16*)it->payload + 1;  // behind the status
  const u8 brr = it->payload[0];
  u16 bytes = 2;
  u8 status = KZ_WRITER_OK;
  if (type == KZ_WRITER_WRITE) {
    status = write(address, (const u16*)(address + 1), (u16)(it->length - 4));
    bytes = 4;  // the low half of the address, which stands there
  } else if (type == KZ_WRITER_INFO) {
    more[0] = (u16)(KZ_WRITER_PROTOCOL << 8 | kz_writer_by_loader);
    more[1] = board;
    bytes = 6;
  } else if (type == KZ_WRITER_RATE) {
    if (it->length != 1 || (u8)(brr - KZ_WRITER_BRR_MIN) > KZ_WRITER_BRR_MAX - KZ_WRITER_BRR_MIN)
      status = KZ_WRITER_ARGUMENTS;
  } else {
    if (rest_is_there) return kz_writer_perform(it);
    status = KZ_WRITER_UNKNOWN;
  }
  it->payload[0] = status;
  kz_writer_reply(it, bytes);
  if (type == KZ_WRITER_RATE && status == KZ_WRITER_OK) kz_writer_rate(brr);
}

static u16 quiet(void) {
  return (u16)(FRT_FRC - last_byte);
}

// What came is thrown away until the line is silent; then a host that has been heard gets a report. A
// frame that comes in meanwhile waits as it does for any other work.
static void complain(void) {
  in = in_end;
  if (quiet() < SILENCE) return;
  next_is_whole = 0;
  damaged = 0;
  work = frames + 1;
  receive_into(frames);
  if (kz_writer_heard) {
    work->type = 0;
    work->number = 0;
    work->payload[0] = KZ_WRITER_DAMAGED;
    kz_writer_reply(work, 2);
  }
  end_work();
}

static void work_off(void) {
  const u8* byte = &work->type;
  u16 left = (u16)(work->length + KZ_WRITER_OVERHEAD - 1);
  kz_writer_crc = 0xFFFF;
  while (left-- != 0) kz_writer_count(*byte++);
  if (kz_writer_crc != 0) {
    damaged = 1;
    return;
  }
  // Replies are another board's, or our own on a shared line: answered, they would never end.
  if (!(work->type & KZ_WRITER_REPLY)) {
    kz_writer_heard = 1;
    kz_writer_silent = 0;
    perform(work);
  }
  end_work();
}

// `loader`: 1 if started by it, and all of the program is there; it waits `seconds`, or without end if 0.
void kz_writer_main(u16 loader, u16 seconds, u16 board_id) {
  kz_writer_by_loader = (u8)loader;
  rest_is_there = (u8)loader;
  filled = kz_writer_rest_start;
  board = board_id;
  kz_writer_heard = 0;
  next_is_whole = 0;
  damaged = 0;
  work = 0;
  receive_into(frames);
  MSTPCRH = MSTPCRH_RESET & (u8)~MSTPCRH_FRT;
  MSTPCRL = MSTPCRL_RESET & (u8)~MSTPCRL_SCI0;
  FRT_TCR = FRT_TCR_PHI_8;
  // Boot mode has left its rate.
  kz_writer_rate((u8)(loader ? KZ_WRITER_BRR_MIN : SCI0_BRR));
  STCR = STCR_FLSHE;
  if (loader) kz_writer_wait_for(seconds);
  for (;;) {
    kz_writer_poll();
    if (work && !damaged) work_off();
    if (in != (u8*)receiving && quiet() >= SILENCE) damaged = 1;
    if (damaged) complain();
    if (rest_is_there) kz_writer_idle();
  }
}
