// Tables and plots of the outcomes, by task and dynamics.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/studies/gait/episode.h"

namespace kaz::gait {

// Returns Markdown: a table for each kind of task, with a row for each task and dynamics.
std::string tables(const studies::EpisodeFile& file, const std::vector<Task>& tasks,
                   const std::vector<std::string>& dynamics);

// Returns the same statistics as JSON, an object for each task and dynamics.
std::string summary_json(const studies::EpisodeFile& file, const std::vector<Task>& tasks,
                         const std::vector<std::string>& dynamics);

// Writes SVG and PNG files to `folder`, which must exist. gait_paths: trunk paths from above, a plot for each
// walking task. gait_turns: histograms of the rotation, a curve for each dynamics.
Result<void> write_plots(const studies::EpisodeFile& file, const std::vector<Task>& tasks,
                         const std::vector<std::string>& dynamics, const std::string& folder);

}  // namespace kaz::gait
