// CRC-16 (polynomial 0x1021, start 0xFFFF) over 1 KiB, bit by bit, `rounds` times.
// SPDX-License-Identifier: Apache-2.0
volatile unsigned rounds;
volatile unsigned result;
static unsigned char data[1024];

static unsigned crc16(const unsigned char* p, unsigned n) {
  unsigned crc = 0xffff;
  unsigned k;
  while (n-- != 0) {
    crc ^= (unsigned)*p++ << 8;
    for (k = 0; k < 8; k++) crc = crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1;
  }
  return crc;
}

int main(void) {
  unsigned k;
  unsigned n;
  for (k = 0; k < sizeof data; k++) data[k] = (unsigned char)(k * 7 + (k >> 8));
  n = rounds;
  while (n-- != 0) result = crc16(data, sizeof data);
  return 0;
}
