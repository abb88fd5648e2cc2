// Product of two 16x16 matrices of 16-bit numbers into 32 bits, `rounds` times.
// SPDX-License-Identifier: Apache-2.0
volatile unsigned rounds;
volatile long result;
static int a[16][16];
static int b[16][16];
static long c[16][16];

static void multiply(void) {
  int i;
  int j;
  int k;
  for (i = 0; i < 16; i++)
    for (j = 0; j < 16; j++) {
      long sum = 0;
      for (k = 0; k < 16; k++) sum += (long)a[i][k] * b[k][j];
      c[i][j] = sum;
    }
}

int main(void) {
  unsigned n;
  int i;
  int j;
  long trace = 0;
  for (i = 0; i < 16; i++)
    for (j = 0; j < 16; j++) {
      a[i][j] = i * 100 - j * 37;
      b[i][j] = j * 55 - i * 91;
    }
  n = rounds;
  while (n-- != 0) multiply();
  for (i = 0; i < 16; i++) trace += c[i][i];
  result = trace;
  return 0;
}
