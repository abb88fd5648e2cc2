// Axis of a plot, linear or logarithmic: maps values to positions, and chooses ticks and labels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kaz::plot {

class Axis {
 public:
  struct Tick {
    double at = 0;      // position, 0..1 along the axis
    std::string label;  // empty: only a grid line
  };
  // Position of an end of a linear axis.
  enum class End {
    exact,      // at the given value
    margin,     // 2 % of the range beyond the given value, so that data do not touch the frame
    whole_step  // at the next multiple of the tick step
  };

  // Returns an axis with about `count` ticks. The tick step is 1, 2 or 5 times a power of ten. If the ends
  // are equal, in reverse order or not finite (no data), a valid range replaces them.
  static Axis linear(double low, double high, int count, End low_end, End high_end);
  // Returns an axis for positive values, with a margin of 2 %. If the ends are not positive and finite, or
  // in reverse order, 1 and 10 replace them.
  static Axis logarithmic(double low, double high);

  // Whether the axis can show the value: finite, and positive on a logarithmic axis.
  bool shows(double value) const;
  double at(double value) const;  // position: 0 to 1 between the ends
  const std::vector<Tick>& ticks() const { return ticks_; }
  // Text of the common factor of the labels, such as "10⁶"; empty if the factor is 1.
  const std::string& factor() const { return factor_; }

 private:
  double scaled(double value) const;
  void add_decades();
  void add_linear_ticks(int count);

  bool logarithmic_ = false;
  double unit_ = 1;            // factor of the labels
  double low_ = 0, high_ = 1;  // ends, scaled
  std::vector<Tick> ticks_;
  std::string factor_;
};

}  // namespace kaz::plot
