// Formats numbers of a report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// Returns the shortest text that parses to the same number; "inf", "-inf"; empty for NaN.
std::string exact_text(double value);
// Returns a readable number with four digits, or, if the error is known, rounded to two digits of the error;
// "none" for NaN.
std::string value_text(double value, double error = 0);
// Returns "0.94 to 0.999", "at most 1", "at least 4" or "none".
std::string limits_text(double low, double high);
// Returns "0.97 ± 0.01 Nm".
std::string value_with_unit(const Measurement& one);

}  // namespace kaz::hil
