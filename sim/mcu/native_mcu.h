// Options of the `native` engine, for tests and comparisons.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sim/mcu/mcu.h"

namespace kaz::sim {

struct NativeOptions {
  // Time from reset to the first tick, with blank non-volatile memory. The chip spends most of this time on
  // the CRC of the application. Therefore the time depends on the size of the application in the image. The
  // default is a measured value. If the image grows, the default is not updated, because
  // recordings depend on the default. `kaz mcu compare --wire` measures the time again and rejects a default
  // that is more than 5 ms from the measured time.
  static constexpr States kDefaultStartStates = 831751;
  States start_states = kDefaultStartStates;
};

std::unique_ptr<Mcu> make_native(const NativeOptions& options);

}  // namespace kaz::sim
