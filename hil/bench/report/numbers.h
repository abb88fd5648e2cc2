// Numbers of a report as text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// As short as it can be and still the same number; "inf", "-inf"; NaN: empty.
std::string exact_text(double value);
// For people: four digits; where the error is known as many as it leaves sense to. NaN: "none".
std::string value_text(double value, double error = 0);
// "0.94 to 0.999", "at most 1", "at least 4", "none"
std::string limits_text(double low, double high);
// "0.97 ± 0.01 Nm"
std::string value_with_unit(const Measurement& one);

}  // namespace kaz::hil
