// A report for tests, with every feature of reports.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/bench/report.h"

namespace kaz::hil {

// The report contains passed, failed and left-out measurements with two limits, one limit or no limit. Values
// include NaN and infinity. The report also contains text that needs quoting, and plots of all styles.
BenchReport test_report();

}  // namespace kaz::hil
