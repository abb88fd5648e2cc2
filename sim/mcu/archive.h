// State to bytes and back, by the names that the simulator uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/h8s/archive.h"

namespace kaz::sim {

using h8s::StateReader;
using h8s::StateWriter;

}  // namespace kaz::sim
