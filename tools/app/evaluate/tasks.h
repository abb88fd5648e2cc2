// Shards of an evaluation as tasks for a scheduler: their script, and the parts that they write.
// SPDX-License-Identifier: Apache-2.0
//
// Each task is `kaz evaluate` with its own --shard. It works in a unique folder, and renames it at the end.
// So a task that runs twice leaves one part: its scheduler may restart it although its lost machine lived on.
// DIR/parts/N is the part of task N.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/output_folder.h"

namespace kaz::tools {

// How a scheduler passes parameters to a task, as shell words.
struct TaskScript {
  std::string head;    // first lines of the script
  std::string number;  // number of the task, 1 to `tasks`: "$1"
  std::string unique;  // unique to this run of the task: "$$"
};

// Returns the words of a command line that a task repeats.
std::vector<std::string> task_words(const std::vector<std::string>& words);
// `program`: path of kaz.
std::string task_script(const TaskScript& by, const std::string& program,
                        const std::vector<std::string>& words, const std::string& folder,
                        int tasks);
// Creates DIR/parts and DIR/`name`, and writes the script there as `file`. Fails if they cannot be created,
// or if `file` exists with other content: the parts of another evaluation could not be merged with these.
Result<void> write_task_script(const std::string& out, const std::string& name,
                               const std::string& file, const std::string& script);

std::string part_folder(const std::string& out, int task);
std::vector<int> without_part(const std::string& out, int tasks);
// Removes the work folders of killed tasks, DIR/parts/N.work.UNIQUE, and nothing else. A running task has
// such a folder, too: call this only while DIR is locked (open_campaign()) and no task runs.
void remove_unfinished(const std::string& out, int tasks);
Result<bool> merge_tasks(const OutputFolder& out, int tasks, bool json);

// Returns "1-3,7" for 1, 2, 3, 7.
std::string array_text(const std::vector<int>& tasks);
// Returns "task 4", "tasks 1-3,7".
std::string task_list(const std::vector<int>& tasks);

}  // namespace kaz::tools
