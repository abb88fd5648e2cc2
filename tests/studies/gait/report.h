// Tables and pictures of the outcomes, steppers side by side.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/gait/results.h"

namespace kaz::gait {

// Markdown: one table for each kind of task, a line for each task and stepper.
std::string tables(const Results& results, const std::vector<Task>& tasks,
                   const std::vector<std::string>& steppers);

// The same figures as JSON, one object for each task and stepper.
std::string summary_json(const Results& results, const std::vector<Task>& tasks,
                         const std::vector<std::string>& steppers);

// Paths of the trunk seen from above, one panel for each task that walks; and how the turns are spread,
// one curve for each stepper. SVG files in `folder`, which must exist.
Result<void> pictures(const Results& results, const std::vector<Task>& tasks,
                      const std::vector<std::string>& steppers, const std::string& folder);

}  // namespace kaz::gait
