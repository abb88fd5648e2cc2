// An axis of a plot, linear or logarithmic: where a value lies along it, its ticks and their labels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kaz::plot {

class Axis {
 public:
  struct Tick {
    double at = 0;      // 0..1 along the axis
    std::string label;  // empty: a grid line only
  };
  // Where an end of a linear axis lies.
  enum class End {
    exact,      // at the given value
    margin,     // 2 % outside of it, so that data at the end keep clear of the frame
    whole_step  // at the next multiple of the tick step
  };

  // About `count` ticks, 1, 2 or 5 times a power of ten apart. The ends may be any numbers: equal, in the
  // wrong order or not finite (no data), they are replaced by a range that can be drawn.
  static Axis linear(double low, double high, int count, End low_end, End high_end);
  // For positive values, with a margin of 2 %. Ends that are not positive, or in the wrong order, are
  // replaced by 1 and 10.
  static Axis logarithmic(double low, double high);

  // False for values that have no place on the axis: not finite, or not positive on a logarithmic one.
  bool shows(double value) const;
  double at(double value) const;  // 0..1 between the ends
  const std::vector<Tick>& ticks() const { return ticks_; }
  // By what the labels are multiplied: "10⁶"; empty: by nothing.
  const std::string& factor() const { return factor_; }

 private:
  double scaled(double value) const;
  void add_decades();
  void add_linear_ticks(int count);

  bool logarithmic_ = false;
  double unit_ = 1;            // of the labels
  double low_ = 0, high_ = 1;  // ends, scaled
  std::vector<Tick> ticks_;
  std::string factor_;
};

}  // namespace kaz::plot
