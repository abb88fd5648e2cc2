// For tests: a report with everything that a report can hold.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/bench/report.h"

namespace kaz::hil {

// Passed, failed and left out; limits on both sides, one and none; NaN and infinite; text that
// needs quoting; plots of all styles.
BenchReport test_report();

}  // namespace kaz::hil
