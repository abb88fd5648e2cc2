// A mix as of ordinary programs, `rounds` times: records, byte strings, calls, small divisions.
// SPDX-License-Identifier: Apache-2.0
//
// No value leaves 16 bits but where it is cut, so that a PC computes the same (guest_test.cpp).
typedef short s16;
typedef unsigned short u16;

volatile u16 rounds;
volatile u16 result;

struct part {
  struct part* next;
  unsigned char name[12];
  s16 count;
  s16 weight;
  signed char kind;
};

static struct part parts[8];
static struct part* first;
static unsigned char text[32];
static s16 table[4][10];

static u16 length(const unsigned char* s) {
  u16 n = 0;
  while (*s++ != 0) n++;
  return n;
}

static void copy(unsigned char* to, const unsigned char* from) {
  while ((*to++ = *from++) != 0) {
  }
}

static s16 compare(const unsigned char* a, const unsigned char* b) {
  while (*a != 0 && *a == *b) {
    a++;
    b++;
  }
  return (s16)(*a - *b);
}

// Decimal digits of a number, the last first.
static u16 digits(unsigned char* to, u16 value) {
  u16 n = 0;
  do {
    to[n++] = (unsigned char)('0' + value % 10);
    value /= 10;
  } while (value != 0);
  to[n] = 0;
  return n;
}

static void build(void) {
  s16 k;
  first = 0;
  for (k = 0; k < 8; k++) {
    struct part* p = &parts[k];
    p->next = first;
    p->kind = (signed char)(k % 3);
    p->count = (s16)(3 * k + 1);
    p->weight = (s16)(1000 * k);
    copy(p->name, (const unsigned char*)"part");
    digits(p->name + 4, (u16)(k * 37));
    first = p;
  }
}

static struct part* find(const unsigned char* name) {
  struct part* p;
  for (p = first; p != 0; p = p->next)
    if (compare(p->name, name) == 0) return p;
  return 0;
}

static s16 weigh(const struct part* p, s16 scale) {
  switch (p->kind) {
    case 0:
      return (s16)(p->weight / 100 + scale);
    case 1:
      return (s16)(p->count * scale);
    default:
      return (s16)(p->count - scale);
  }
}

static void fill(s16 row, s16 value) {
  s16 k;
  for (k = 0; k < 10; k++) {
    table[row][k] = (s16)(value + k);
    if (k > 2 && (value & 1)) table[row][k] = (s16)(table[row][k] + table[row][k - 3]);
  }
}

static u16 once(u16 n) {
  struct part local;
  struct part* p;
  u16 sum = n;
  copy(text, (const unsigned char*)"part");
  digits(text + 4, (u16)(n % 8 * 37));
  p = find(text);
  if (p == 0) return 0;
  local.kind = p->kind;
  local.weight = p->weight;
  local.count = (s16)(p->count + n % 7);
  copy(local.name, p->name);
  sum = (u16)(sum + weigh(&local, (s16)(n & 15)));
  fill((s16)(n & 3), local.count);
  for (p = first; p != 0; p = p->next) {
    if (p->kind == local.kind) p->count = (s16)((p->count + local.count) % 1000);
    sum = (u16)((sum << 1 | sum >> 15) ^ p->count);
  }
  return (u16)(sum + table[n & 3][n % 10] + length(local.name));
}

int main(void) {
  u16 n;
  u16 sum = 0;
  build();
  n = rounds;
  while (n-- != 0) sum = (u16)((sum ^ once(n)) + 1);
  result = sum;
  return 0;
}
