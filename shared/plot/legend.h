// Legend of a plot: collects, places and paints the entries.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/plot/painter.h"

namespace kaz::plot {

class Legend {
 public:
  Legend() = default;
  // Places the entries right-aligned in the line of the title if there is room, otherwise in lines below the
  // title. `width_px` is the width of the plot's frame.
  Legend(const LinePlot& plot, double width_px, double title_width_px);

  double height() const { return height_; }  // height of the lines below the title, px
  void paint(Painter& painter, Point title_baseline) const;

 private:
  enum class Mark { line, dashed, dot, area };
  struct Entry {
    Mark mark;
    std::string label;
    Color color;
    Point offset = {};  // distance from the start of the title's baseline, px
    double width() const;
  };
  void collect(const LinePlot& plot);

  std::vector<Entry> entries_;
  double height_ = 0;
};

}  // namespace kaz::plot
