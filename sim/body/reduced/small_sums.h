// Dot products and sums of short vectors, in a fixed order. The order is efficient for registers of two
// doubles (SSE2).
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::sim {

inline double dot(const double* a, const double* b, int n) {
  double even = 0, odd = 0;
  int i = 0;
  for (; i + 1 < n; i += 2) {
    even += a[i] * b[i];
    odd += a[i + 1] * b[i + 1];
  }
  if (i < n) even += a[i] * b[i];
  return even + odd;
}

inline double dot_six(const double* a, const double* b) {
  return (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5]);
}

// Computes to[i] += by * from[i] for each i from 0 to n - 1. The two arrays must not overlap.
inline void add_range(double by, const double* __restrict from, double* __restrict to, int n) {
  if (n == 6) {
    for (int i = 0; i < 6; ++i) to[i] += by * from[i];
    return;
  }
  for (int i = 0; i < n; ++i) to[i] += by * from[i];
}

}  // namespace kaz::sim
