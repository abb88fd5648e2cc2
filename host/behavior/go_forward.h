// go-forward: walks straight ahead for a distance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/behavior/behavior.h"

namespace kaz::behavior {

extern const Behavior kGoForward;

}  // namespace kaz::behavior
