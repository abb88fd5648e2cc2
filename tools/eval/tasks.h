// Splits an evaluation into tasks for a scheduler: script of the tasks, and parts that tasks write.
// SPDX-License-Identifier: Apache-2.0
//
// Each task is `kaz evaluate` with its own --shard. A task works in a unique folder, and renames this folder
// at the end. So a task that runs twice still produces only one part. A scheduler may run a task twice if the
// scheduler loses contact with a machine that keeps running. DIR/parts/N is the part of task N.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/base/output_file.h"

namespace kaz::tools {

// Shell words with which a scheduler passes parameters to a task.
struct TaskScript {
  std::string head;    // first lines of the script
  std::string number;  // number of the task, 1 to `tasks`: "$1"
  std::string unique;  // text that is unique to this run of the task: "$$"
};

// Returns those words of the command line that each task repeats.
std::vector<std::string> task_words(const std::vector<std::string>& words);
// Returns the script of the tasks. `program`: path of the executable kaz.
std::string task_script(const TaskScript& by, const std::string& program,
                        const std::vector<std::string>& words, const std::string& folder,
                        int tasks);
// Creates the folders DIR/parts and DIR/`name`, and writes the script to DIR/`name`/`file`. Fails if a folder
// or the file cannot be written. Also fails if the file exists with other content. The file then belongs to
// another evaluation, whose parts could not be merged with the new parts.
Result<void> write_task_script(const std::string& out, const std::string& name,
                               const std::string& file, const std::string& script);

std::string part_folder(const std::string& out, int task);
std::vector<int> without_part(const std::string& out, int tasks);
// Removes the work folders of killed tasks, DIR/parts/N.work.UNIQUE, and nothing else. A running task has
// such a folder, too. So call remove_unfinished() only while DIR is locked (open_campaign()) and no task
// runs.
void remove_unfinished(const std::string& out, int tasks);
Result<bool> merge_tasks(const OutputFolder& out, int tasks, bool json);

// Returns the numbers in Slurm's notation of an array: "1-3,7" for 1, 2, 3, 7.
std::string array_text(const std::vector<int>& tasks);
// Returns the numbers for a message: "task 4" or "tasks 1-3,7".
std::string task_list(const std::vector<int>& tasks);

}  // namespace kaz::tools
