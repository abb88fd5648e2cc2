// Plots the tables: distance error over distance, and difficult images with their detections.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/studies/vision_table/table.h"

namespace kaz::vision_table {

// Writes a PNG file. `table` must have the rows of whole balls. Errors: the renderer does not start, or the
// file cannot be written.
Result<void> write_plot(const std::string& path, const Table& table);

}  // namespace kaz::vision_table
