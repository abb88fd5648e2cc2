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
    std::string label;  // text beside the grid line; may be empty
  };
  // Position of an end of a linear axis.
  enum class End {
    exact,      // at the given value
    margin,     // the axis continues beyond the given value by 2 % of the range
    whole_step  // at the next multiple of the tick step
  };

  // Returns an axis with about `count` ticks. The tick step is 1, 2 or 5 times a power of ten. If the ends
  // are equal, in reverse order or not finite (no data), the axis gets a valid range instead.
  static Axis linear(double low, double high, int count, End low_end, End high_end);
  // Returns an axis for positive values, with a margin of 2 %. If an end is zero, negative or not finite, or
  // if the ends are in reverse order, the axis goes from 1 to 10.
  static Axis logarithmic(double low, double high);

  // Returns whether the axis can show the value. The value must be finite. On a logarithmic axis, the value
  // must also be positive.
  bool shows(double value) const;
  double at(double value) const;  // position on the axis: 0 to 1 between the ends
  const std::vector<Tick>& ticks() const { return ticks_; }
  // Returns the common factor of all labels as text, such as "10⁶"; empty if the factor is 1.
  const std::string& factor() const { return factor_; }

 private:
  double scaled(double value) const;
  void add_decades();
  void add_linear_ticks(int count);

  bool logarithmic_ = false;
  double unit_ = 1;            // the labels show values divided by this factor
  double low_ = 0, high_ = 1;  // ends of the axis, converted by scaled()
  std::vector<Tick> ticks_;
  std::string factor_;
};

}  // namespace kaz::plot
