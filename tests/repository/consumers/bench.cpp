// The bench's measurements with their limits.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "hil/bench/measurement.h"

int main() {
  for (const auto& info : kaz::hil::measurement_infos()) std::printf("%s ", info.name.c_str());
  std::printf("\n");
  return kaz::hil::measurement_infos().empty() ? 1 : 0;
}
