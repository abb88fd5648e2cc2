// Writes to standard output and ends with a status: the smallest program for the flat machine.
// SPDX-License-Identifier: Apache-2.0
#include "host.h"

int main(void) {
  unsigned long sum = 0;
  int k;
  for (k = 1; k <= 1000; ++k) sum += (unsigned long)k;
  print("sum of 1 to %d is %lu, %08lx in hex\n", 1000, sum, sum);
  return 3;
}
