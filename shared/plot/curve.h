// Curves in px, reduced to what can be seen of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "shared/plot/painter.h"

namespace kaz::plot {

// Of consecutive points in one column of pixels the first, the lowest, the highest and the last.
std::vector<Point> thinned(std::span<const Point> line);

// The pieces of the line within `area`, edges included, each of two points or more. Liang & Barsky, "A new
// concept and method for line clipping", ACM Transactions on Graphics 3 (1984), segment by segment.
std::vector<std::vector<Point>> clipped(std::span<const Point> line, const Rectangle& area);

// Those within `area`, edges included; of several within the same half pixel the first.
std::vector<Point> distinct(std::span<const Point> points, const Rectangle& area);

}  // namespace kaz::plot
