// Reduces curves and point clouds (in px) to the visible parts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "shared/plot/painter.h"

namespace kaz::plot {

// If consecutive points lie in one pixel column, keeps only the first, lowest, highest and last of these
// points.
std::vector<Point> thinned(std::span<const Point> line);

// Returns the pieces of the line within `area`, edges included. Each piece has at least two points.
// Liang & Barsky, "A new concept and method for line clipping", ACM Transactions on Graphics 3 (1984).
std::vector<std::vector<Point>> clipped(std::span<const Point> line, const Rectangle& area);

// Returns the points within `area`, edges included. If several points lie in the same half pixel, keeps only
// the first.
std::vector<Point> distinct(std::span<const Point> points, const Rectangle& area);

}  // namespace kaz::plot
