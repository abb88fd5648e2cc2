// The `native` engine: options for tests and comparisons.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sim/mcu/mcu.h"

namespace kaz::sim {

struct NativeOptions {
  // From reset to the first tick, with nothing stored. The chip spends most of it on the CRC of its
  // application, so it depends on the image; the default was measured on a built one. It stays as
  // the image grows, since recordings depend on it; `kaz mcu compare --wire` measures it again and
  // rejects a default that is 5 ms off.
  static constexpr States default_start_states = 831751;
  States start_states = default_start_states;
};

std::unique_ptr<Mcu> make_native(const NativeOptions& options);

}  // namespace kaz::sim
