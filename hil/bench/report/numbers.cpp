// Numbers for machines and for people.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/report/numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "hil/report/page.h"

namespace kaz::hil {
namespace {

constexpr int kDigits = 4;

int decimal_place(double value) {
  return static_cast<int>(std::floor(std::log10(std::abs(value))));
}

std::string without_trailing_zeros(std::string text) {
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

// Too large or too small to be written out.
bool extreme(double value) {
  return value != 0 && (std::abs(value) >= 1e7 || std::abs(value) < 1e-5);
}

std::string with_digits(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace

std::string exact_text(double value) {
  if (std::isnan(value)) return {};
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string value_text(double value, double error) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return value > 0 ? "infinity" : "minus infinity";
  if (extreme(value)) return with_digits(value, kDigits);
  if (error > 0 && std::isfinite(error)) {
    return fixed(value, std::clamp(1 - decimal_place(error), 0, 9));
  }
  const int decimals = value == 0 ? 0 : kDigits - 1 - decimal_place(value);
  return without_trailing_zeros(fixed(value, std::clamp(decimals, 0, 9)));
}

std::string limits_text(double low, double high) {
  if (std::isinf(low) && std::isinf(high)) return "none";
  if (std::isinf(low)) return "at most " + with_digits(high, 6);
  if (std::isinf(high)) return "at least " + with_digits(low, 6);
  return with_digits(low, 6) + " to " + with_digits(high, 6);
}

std::string value_with_unit(const Measurement& one) {
  std::string text = value_text(one.value, one.error);
  if (one.error > 0 && std::isfinite(one.error) && std::isfinite(one.value)) {
    text += " ± " + with_digits(one.error, 2);
  }
  return one.of->unit.empty() || !std::isfinite(one.value) ? text : text + " " + one.of->unit;
}

}  // namespace kaz::hil
