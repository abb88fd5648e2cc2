// The behaviour that docs/host.md shows how to write.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kNod;

}  // namespace kaz::behavior
