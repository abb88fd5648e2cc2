// A picture of the tables: distance errors over the distance, and hard pictures with what was found.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/studies/vision_table/table.h"

namespace kaz::vision_table {

// What is asked of the ball's distance: 95 % of the errors are less than this share.
double due(int width, double distance_m);

// Needs the rows of whole balls. Errors where OpenGL or the file cannot be had.
Result<void> write_picture(const std::string& path, const Table& table);

}  // namespace kaz::vision_table
