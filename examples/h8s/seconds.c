// A program of one's own for the H8S/2128: counts tenths of a second on SCI0, and P30 blinks.
// SPDX-License-Identifier: Apache-2.0
// A timer's interrupt counts; 9600 baud; crystal: 18.432 MHz.

#define REG8(address) (*(volatile unsigned char*)(0xFF0000UL + (address)))
#define REG16(address) (*(volatile unsigned short*)(0xFF0000UL + (address)))

/* Hardware manual of the H8S/2138 group: appendix B. */
#define MSTPCRH REG8(0xFF86) /* module stop: bit 5 timer FRT */
#define MSTPCRL REG8(0xFF87) /* bit 7 SCI0 */
#define TIER REG8(0xFF90)
#define TCSR REG8(0xFF91)
#define FRC REG16(0xFF92)
#define OCRA REG16(0xFF94)
#define TCR REG8(0xFF96)
#define TOCR REG8(0xFF97)
#define P3DDR REG8(0xFFB4)
#define P3DR REG8(0xFFB6)
#define SMR REG8(0xFFD8)
#define BRR REG8(0xFFD9)
#define SCR REG8(0xFFDA)
#define TDR REG8(0xFFDB)
#define SSR REG8(0xFFDC)

#define COUNTS_PER_TICK 57600 /* of 32 states: 0.1 s */

static volatile unsigned short tenths = 0;
static unsigned char greeting[] = "tenths of a second: ";

#pragma interrupt
void tick(void) {
  TCSR &= (unsigned char)~0x08; /* OCFA */
  ++tenths;
  P3DR ^= 0x01;
}

static void put(unsigned char byte) {
  while (!(SSR & 0x80)) { /* TDRE */
  }
  TDR = byte;
  SSR &= (unsigned char)~0x80;
}

static void put_number(unsigned short number) {
  unsigned char digits[5];
  unsigned char count = 0;
  do {
    digits[count++] = (unsigned char)('0' + number % 10);
    number /= 10;
  } while (number);
  while (count) put(digits[--count]);
}

/* No interrupt comes between the look at what it counted and SLEEP: it is accepted at the earliest after the
   instruction that follows ANDC. */
static void wait_for_other_than(unsigned short seen) {
  for (;;) {
    __asm__ volatile("orc #0x80,ccr");
    if (tenths != seen) break;
    __asm__ volatile("andc #0x7f,ccr\n\tsleep");
  }
  __asm__ volatile("andc #0x7f,ccr");
}

int main(void) {
  unsigned short seen = 0;
  const unsigned char* text;
  MSTPCRH = 0x1F;
  MSTPCRL = 0x7F;
  P3DDR = 0x01;
  SMR = 0;
  BRR = 59; /* 18.432 MHz / 32 / 9600 - 1 */
  SCR = 0x20;
  TCR = 0x02; /* a count each 32 states */
  TOCR = 0;
  OCRA = COUNTS_PER_TICK - 1;
  TCSR = 0x01; /* cleared by compare match A */
  FRC = 0;
  TIER = 0x09;
  for (text = greeting; *text; ++text) put(*text);
  for (;;) {
    wait_for_other_than(seen);
    ++seen;
    put_number(seen);
    put(' ');
  }
}
