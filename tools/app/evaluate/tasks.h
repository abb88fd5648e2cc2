// Shards of an evaluation as tasks that others run: their script, and the parts that they leave.
// SPDX-License-Identifier: Apache-2.0
//
// Each task is `kaz evaluate` with a --shard of its own. It works in a folder that no other has and renames
// that at the end, so a task that runs twice (begun again when its machine was given up, though it lived on)
// leaves one part. DIR/parts/N is the part of task N.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/app/base/output_folder.h"

namespace kaz::tools {

// How those who run a task call it, in words of the shell.
struct TaskScript {
  std::string head;    // lines before all
  std::string number;  // 1..tasks: "$1"
  std::string unique;  // that no other run of this task has: "$$"
};

// Of the words of a command line, those that a task repeats.
std::vector<std::string> task_words(const std::vector<std::string>& words);
// `program`: the path of kaz.
std::string task_script(const TaskScript& by, const std::string& program,
                        const std::vector<std::string>& words, const std::string& folder,
                        int tasks);
// Makes DIR/parts and DIR/`name`, and writes the script there as `file`. Errors: they cannot be made; `file`
// is there and is another evaluation's, whose parts would be no whole with these.
Result<void> write_task_script(const std::string& out, const std::string& name,
                               const std::string& file, const std::string& script);

std::string part_folder(const std::string& out, int task);
std::vector<int> without_part(const std::string& out, int tasks);
// Removes the work folders that killed tasks left, DIR/parts/N.work.UNIQUE, and nothing else. A running task
// has such a folder too: call it only while DIR is locked (open_campaign) and no task runs.
void remove_unfinished(const std::string& out, int tasks);
Result<bool> merge_tasks(const OutputFolder& out, int tasks, bool json);

// "1-3,7" of 1, 2, 3, 7.
std::string array_text(const std::vector<int>& tasks);
// "task 4", "tasks 1-3,7".
std::string task_list(const std::vector<int>& tasks);

}  // namespace kaz::tools
