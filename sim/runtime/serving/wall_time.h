// Reads the wall clock (CLOCK_MONOTONIC) as Time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include "shared/base/time.hpp"

namespace kaz::sim {

inline Time monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Time(std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec);
}

}  // namespace kaz::sim
