// The plot of the tables: distance errors over distance, and difficult images with their detections.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/studies/vision_table/table.h"

namespace kaz::vision_table {

// Needs the rows of whole balls. Errors: the renderer does not start; the file cannot be written.
Result<void> write_plot(const std::string& path, const Table& table);

}  // namespace kaz::vision_table
