// Reduces curves and point clouds, in px, to their visible parts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "shared/plot/painter.h"

namespace kaz::plot {

// Keeps, of consecutive points in one pixel column, the first, the lowest, the highest and the last.
std::vector<Point> thinned(std::span<const Point> line);

// Returns the pieces of the line within `area`, edges included. Each piece has at least two points.
// Liang & Barsky, "A new concept and method for line clipping", ACM Transactions on Graphics 3 (1984).
std::vector<std::vector<Point>> clipped(std::span<const Point> line, const Rectangle& area);

// Returns the points within `area`, edges included. Keeps only one per half pixel, the first.
std::vector<Point> distinct(std::span<const Point> points, const Rectangle& area);

}  // namespace kaz::plot
