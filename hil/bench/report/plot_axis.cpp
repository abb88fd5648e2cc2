// Linear axes by shared/plot; decades for logarithmic ones.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/report/plot_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/plot/axis.h"

namespace kaz::hil {
namespace {

constexpr int kMostDecades = 8;      // that have a label
constexpr double kFewDecades = 2.6;  // where 2 and 5 have one too

// "10⁻⁶"
std::string power_of_ten(int exponent) {
  static const char* const kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

// Labels stay short: beyond four digits on either side of the point they get a common factor.
int common_exponent(double low, double high) {
  const double largest = std::max(std::abs(low), std::abs(high));
  if (largest == 0 || !std::isfinite(largest)) return 0;
  const int exponent = static_cast<int>(std::floor(std::log10(largest)));
  if (exponent > -4 && exponent < 5) return 0;
  return std::clamp(3 * static_cast<int>(std::floor(exponent / 3.0)), -306, 306);
}

std::string decade_label(int exponent, int digit) {
  if (exponent < -3 || exponent > 4) {
    return (digit == 1 ? "" : std::to_string(digit) + "·") + power_of_ten(exponent);
  }
  char text[24];
  std::snprintf(text, sizeof text, "%.*f", std::max(-exponent, 0), digit * std::pow(10, exponent));
  return text;
}

}  // namespace

PlotAxis PlotAxis::linear(double low, double high, int count, bool widen) {
  PlotAxis made;
  if (!(low <= high)) {
    low = 0;
    high = 1;
  }
  const int exponent = common_exponent(low, high);
  if (exponent != 0) made.factor_ = power_of_ten(exponent);
  made.unit_ = std::pow(10, exponent);
  const plot::Axis axis = plot::make_axis(low / made.unit_, high / made.unit_, count, widen);
  // Where the ends stay, what lies at them keeps clear of the frame.
  const double margin = widen ? 0 : 0.02 * (axis.high - axis.low);
  made.low_ = axis.low - margin;
  made.high_ = axis.high + margin;
  for (const double tick : axis.ticks()) {
    made.ticks_.push_back({made.at(tick * made.unit_), axis.label(tick)});
  }
  return made;
}

PlotAxis PlotAxis::logarithmic(double low, double high) {
  PlotAxis made;
  made.logarithmic_ = true;
  if (!(low > 0 && low <= high)) {
    low = 1;
    high = 10;
  }
  const double room = low == high ? 0.3 : 0.02 * (std::log10(high) - std::log10(low));
  made.low_ = std::log10(low) - room;
  made.high_ = std::log10(high) + room;
  made.add_decades(static_cast<int>(std::floor(made.low_)),
                   static_cast<int>(std::floor(made.high_)));
  const auto labelled = std::count_if(made.ticks_.begin(), made.ticks_.end(),
                                      [](const Tick& tick) { return !tick.label.empty(); });
  if (labelled < 2) made.add_linear_ticks(4);
  return made;
}

void PlotAxis::add_decades(int first, int last) {
  const int decades = last - first + 1;
  const bool few = high_ - low_ <= kFewDecades;
  const int step = (decades + kMostDecades - 1) / kMostDecades;
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double place = decade + std::log10(digit);
      if (place < low_ || place > high_ || (digit > 1 && step > 1)) continue;
      const bool labelled = digit == 1 ? decade % step == 0 : few && (digit == 2 || digit == 5);
      if (digit == 1 && !labelled) continue;
      ticks_.push_back({(place - low_) / (high_ - low_),
                        labelled ? decade_label(decade, digit) : std::string()});
    }
  }
}

// Within less than a decade round numbers lie between 1, 2 and 5.
void PlotAxis::add_linear_ticks(int count) {
  ticks_.clear();
  const PlotAxis even =
      linear(std::pow(10, low_), std::min(std::pow(10, high_), 1e308), count, false);
  factor_ = even.factor_;
  for (const Tick& tick : even.ticks_) {
    const double value = (even.low_ + tick.at * (even.high_ - even.low_)) * even.unit_;
    if (value > 0) ticks_.push_back({at(value), tick.label});
  }
}

double PlotAxis::scaled(double value) const {
  return logarithmic_ ? std::log10(value) : value / unit_;
}

bool PlotAxis::shows(double value) const {
  return std::isfinite(value) && (!logarithmic_ || value > 0);
}

double PlotAxis::at(double value) const {
  return (scaled(value) - low_) / (high_ - low_);
}

}  // namespace kaz::hil
