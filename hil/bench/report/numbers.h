// Formats numbers of a report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// Returns the shortest text that parses to the same number. The text is "inf" or "-inf" for an infinite
// number, and empty for NaN.
std::string exact_text(double value);
// Returns a readable number. If `error` is known, the number is rounded at the decimal place of the second
// significant digit of `error`. Otherwise the number has at most four significant digits. The text for NaN is
// "none".
std::string value_text(double value, double error = 0);
// Returns a text such as "0.94 to 0.999", "at most 1", "at least 4" or "none".
std::string limits_text(double low, double high);
// Returns a text such as "0.97 ± 0.01 Nm".
std::string value_with_unit(const Measurement& one);

}  // namespace kaz::hil
