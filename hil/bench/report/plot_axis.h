// An axis of a plot: where a value lies along it, its ticks, and their labels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/bench/measurement.h"

namespace kaz::hil {

class PlotAxis {
 public:
  struct Tick {
    double at = 0;      // 0..1 along the axis
    std::string label;  // empty: a line of the grid alone
  };
  // About `count` ticks for values from `low` to `high`, which may be equal, or in the wrong order
  // where there are none. `widen`: the ends move out to whole steps.
  static PlotAxis linear(double low, double high, int count, bool widen);
  // For positive values.
  static PlotAxis logarithmic(double low, double high);

  // Whether there is a place for this value at all.
  bool shows(double value) const;
  double at(double value) const;  // 0..1 within the ends
  const std::vector<Tick>& ticks() const { return ticks_; }
  // What the labels are to be multiplied by: "10⁶"; empty: nothing.
  const std::string& factor() const { return factor_; }

 private:
  double scaled(double value) const;
  void add_linear_ticks(int count);
  void add_decades(int first, int last);

  bool logarithmic_ = false;
  double unit_ = 1;            // of the labels
  double low_ = 0, high_ = 1;  // scaled
  std::vector<Tick> ticks_;
  std::string factor_;
};

}  // namespace kaz::hil
