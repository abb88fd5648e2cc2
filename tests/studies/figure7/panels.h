// Both maps of a sweep side by side, true edges drawn in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/studies/figure7/sweep.h"

namespace kaz::figure7 {

vision::Image panels(const Sweep& sweep);

}  // namespace kaz::figure7
