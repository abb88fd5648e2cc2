// Random numbers that are the same on every machine, by the name that the simulator uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/random.hpp"

namespace kaz::sim {

using kaz::keyed_normal;
using kaz::mix64;
using kaz::Random;

}  // namespace kaz::sim
