// Linear axes with round steps, logarithmic axes with decades.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kaz::plot {
namespace {

constexpr double kMargin = 0.02;            // of the length of an axis
constexpr int kMaxLabelledDecades = 8;      // with more, only every second, third, ... has a label
constexpr double kMaxDividedDecades = 2.6;  // up to here 2 and 5 have labels, too
constexpr int kMaxTicks = 1000;

// "10⁻⁶"
std::string power_of_ten(int exponent) {
  static const char* const kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

// Labels stay short: beyond four digits on either side of the decimal point they get a common factor, whose
// exponent is a multiple of 3.
int common_exponent(double low, double high) {
  const double largest = std::max(std::abs(low), std::abs(high));
  if (largest == 0 || !std::isfinite(largest)) return 0;
  const int exponent = static_cast<int>(std::floor(std::log10(largest)));
  if (exponent > -4 && exponent < 5) return 0;
  return std::clamp(3 * static_cast<int>(std::floor(exponent / 3.0)), -306, 306);
}

// The smallest of 1, 2, 5 or 10 times a power of ten that divides the range into at most `count` steps.
double round_step(double range, int count) {
  const double raw = range / std::max(count, 1);
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * 0.999) return factor * power;
  }
  return 10 * power;
}

// With as many decimals as the step needs.
std::string step_label(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
  std::array<char, 64> text{};
  const double shown = std::abs(value) < 1e-9 * step ? 0 : value;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, shown);
  std::string label = text.data();
  if (label[0] == '-') label.replace(0, 1, "\u2212");  // a minus sign, as wide as a plus
  return label;
}

std::string decade_label(int exponent, int digit) {
  if (exponent < -3 || exponent > 4) {
    return (digit == 1 ? "" : std::to_string(digit) + "·") + power_of_ten(exponent);
  }
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%.*f", std::max(-exponent, 0),
                digit * std::pow(10, exponent));
  return text.data();
}

}  // namespace

Axis Axis::linear(double low, double high, int count, End low_end, End high_end) {
  if (!std::isfinite(low)) low = std::isfinite(high) ? high - 1 : 0;
  if (!std::isfinite(high)) high = low + 1;
  if (high < low) {
    std::swap(low, high);
    std::swap(low_end, high_end);
  }
  Axis axis;
  const int exponent = common_exponent(low, high);
  if (exponent != 0) axis.factor_ = power_of_ten(exponent);
  axis.unit_ = std::pow(10, exponent);
  low /= axis.unit_;
  high /= axis.unit_;
  if (!(high - low > 1e-9 * std::max(std::abs(low), std::abs(high))) || high == low) {
    const double margin = std::max(std::abs(low) * 0.1, 0.5);
    const bool both = low_end == End::exact && high_end == End::exact;
    if (low_end != End::exact || both) low -= margin;
    if (high_end != End::exact || both) high += margin;
  }
  const double step = round_step(high - low, count), range = high - low;
  if (low_end == End::whole_step) low = std::floor(low / step + 1e-9) * step;
  if (high_end == End::whole_step) high = std::ceil(high / step - 1e-9) * step;
  const double first = std::ceil(low / step - 1e-6);
  axis.low_ = low - (low_end == End::margin ? kMargin * range : 0);
  axis.high_ = high + (high_end == End::margin ? kMargin * range : 0);
  for (int i = 0; i < kMaxTicks; ++i) {
    const double value = (first + i) * step;
    if (value > high + 1e-6 * step) break;
    axis.ticks_.push_back(
        {(value - axis.low_) / (axis.high_ - axis.low_), step_label(value, step)});
  }
  return axis;
}

Axis Axis::logarithmic(double low, double high) {
  if (!(low > 0 && low <= high && std::isfinite(high))) {
    low = 1;
    high = 10;
  }
  Axis axis;
  axis.logarithmic_ = true;
  const double room = low == high ? 0.3 : kMargin * (std::log10(high) - std::log10(low));
  axis.low_ = std::log10(low) - room;
  axis.high_ = std::log10(high) + room;
  axis.add_decades();
  const auto labelled = std::count_if(axis.ticks_.begin(), axis.ticks_.end(),
                                      [](const Tick& tick) { return !tick.label.empty(); });
  if (labelled < 2) axis.add_linear_ticks(4);
  return axis;
}

void Axis::add_decades() {
  const int first = static_cast<int>(std::floor(low_)), last = static_cast<int>(std::floor(high_));
  const bool divided = high_ - low_ <= kMaxDividedDecades;
  const int step = (last - first + kMaxLabelledDecades) / kMaxLabelledDecades;
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double place = decade + std::log10(digit);
      if (place < low_ || place > high_ || (digit > 1 && step > 1)) continue;
      const bool labelled = digit == 1 ? decade % step == 0 : divided && (digit == 2 || digit == 5);
      if (digit == 1 && !labelled) continue;
      ticks_.push_back({(place - low_) / (high_ - low_),
                        labelled ? decade_label(decade, digit) : std::string()});
    }
  }
}

// Within less than a decade the ticks of a linear axis are at more places than 1, 2 and 5.
void Axis::add_linear_ticks(int count) {
  const Axis even = linear(std::pow(10, low_), std::min(std::pow(10, high_), 1e308), count,
                           End::exact, End::exact);
  ticks_.clear();
  factor_ = even.factor_;
  for (const Tick& tick : even.ticks_) {
    const double value = (even.low_ + tick.at * (even.high_ - even.low_)) * even.unit_;
    if (value > 0) ticks_.push_back({at(value), tick.label});
  }
}

double Axis::scaled(double value) const {
  return logarithmic_ ? std::log10(value) : value / unit_;
}

bool Axis::shows(double value) const {
  return std::isfinite(value) && (!logarithmic_ || value > 0);
}

double Axis::at(double value) const {
  return (scaled(value) - low_) / (high_ - low_);
}

}  // namespace kaz::plot
