// The legend of a plot: its entries, and where they are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/plot/painter.h"

namespace kaz::plot {

class Legend {
 public:
  Legend() = default;
  // Right-aligned in the line of the title where that has room, else in lines beneath it. `width_px`: of
  // the plot's frame.
  Legend(const LinePlot& plot, double width_px, double title_width_px);

  double height() const { return height_; }  // of the lines beneath the title, px
  void paint(Painter& painter, Point title_baseline) const;

 private:
  enum class Mark { line, dashed, dot, area };
  struct Entry {
    Mark mark;
    std::string label;
    Color color;
    Point offset = {};  // from the title's baseline
    double width() const;
  };
  void collect(const LinePlot& plot);

  std::vector<Entry> entries_;
  double height_ = 0;
};

}  // namespace kaz::plot
