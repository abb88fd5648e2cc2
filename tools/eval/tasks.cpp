// Writes the script of an evaluation's tasks, and looks after their parts.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/tasks.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <set>
#include <utility>

#include "shared/base/files.hpp"
#include "shared/base/shell_word.hpp"
#include "tools/eval/campaign.h"

namespace kaz::tools {

namespace fs = std::filesystem;

namespace {

// A task works in DIR/parts/N.work.UNIQUE. UNIQUE is letters, digits, dots and hyphens; it ends with a dot
// and the number of a process.
constexpr const char* kWork = ".work.";

bool is_work_folder(const std::string& name, int tasks) {
  const std::size_t at = name.find(kWork);
  if (at == std::string::npos) return false;
  const std::string unique = name.substr(at + std::strlen(kWork));
  const std::size_t dot = unique.rfind('.');
  if (dot == 0 || dot == std::string::npos || dot + 1 == unique.size() ||
      unique.find_first_not_of("0123456789", dot + 1) != std::string::npos ||
      !std::ranges::all_of(
          unique, [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-'; }))
    return false;
  const std::string task = name.substr(0, at), last = std::to_string(tasks);
  return !task.empty() && task[0] != '0' &&
         task.find_first_not_of("0123456789") == std::string::npos &&
         std::pair(task.size(), task) <= std::pair(last.size(), last);
}

}  // namespace

std::vector<std::string> task_words(const std::vector<std::string>& words) {
  static const std::set<std::string, std::less<>> kWithValue{
      "--slurm", "--sbatch", "--parallel-hosts", "--parallel-tasks", "--out"};
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string name = words[i].substr(0, words[i].find('='));
    if (kWithValue.contains(name)) {
      if (name == words[i]) ++i;
    } else if (words[i] != "--json") {
      kept.push_back(words[i]);
    }
  }
  return kept;
}

std::string task_script(const TaskScript& by, const std::string& program,
                        const std::vector<std::string>& words, const std::string& folder,
                        int tasks) {
  std::string command = shell_word(program);
  for (const std::string& word : words) command += " " + shell_word(word);
  return "#!/bin/sh\n"
         "# A task of an evaluation, written by kaz evaluate. The task may run twice: the run that "
         "ends first counts.\n" +
         by.head + "task=" + by.number + "\npart=" + shell_word(folder + "/parts") +
         "/$task\n"
         "if [ -e \"$part/result.json\" ]; then exit 0; fi\n"
         "work=$part" +
         kWork + by.unique + "\n" + command + " --shard \"$task/" + std::to_string(tasks) +
         "\" --out \"$work\"\n"
         "status=$?\n"
         "# Status 1: no episode succeeded, which is also a result.\n"
         "if [ $status -gt 1 ]; then exit $status; fi\n"
         "mv -T \"$work\" \"$part\" 2>/dev/null || rm -rf \"$work\"\n";
}

Result<void> write_task_script(const std::string& out, const std::string& name,
                               const std::string& file, const std::string& script) {
  for (const std::string& folder : {out + "/parts", out + "/" + name}) {
    std::error_code wrong;
    fs::create_directories(folder, wrong);
    if (wrong)
      return fail(Fault::environment, "--out: cannot create '" + folder + "': " + wrong.message());
  }
  const std::string path = out + "/" + name + "/" + file;
  const auto earlier = read_whole_file(path, 1 << 20);
  if (earlier && *earlier != script)
    return fail(Fault::usage, "--out: '" + out + "' contains the tasks of another evaluation (" +
                                  name + "/" + file +
                                  "): give the same options, or another folder");
  return write_whole_file(path, script);
}

std::string part_folder(const std::string& out, int task) {
  return out + "/parts/" + std::to_string(task);
}

std::vector<int> without_part(const std::string& out, int tasks) {
  std::vector<int> missing;
  for (int task = 1; task <= tasks; ++task) {
    if (!fs::exists(part_folder(out, task) + "/result.json")) missing.push_back(task);
  }
  return missing;
}

void remove_unfinished(const std::string& out, int tasks) {
  std::error_code none;
  std::vector<fs::path> unfinished;
  for (const auto& entry : fs::directory_iterator(out + "/parts", none)) {
    if (entry.symlink_status(none).type() == fs::file_type::directory &&
        is_work_folder(entry.path().filename().string(), tasks))
      unfinished.push_back(entry.path());
  }
  for (const fs::path& folder : unfinished) fs::remove_all(folder, none);
}

Result<bool> merge_tasks(const OutputFolder& out, int tasks, bool json) {
  std::vector<std::string> parts;
  for (int task = 1; task <= tasks; ++task) parts.push_back(part_folder(out.folder(), task));
  return merge_campaigns(parts, out, json);
}

std::string array_text(const std::vector<int>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size();) {
    std::size_t last = i;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(tasks[i]);
    if (last > i) text += "-" + std::to_string(tasks[last]);
    i = last + 1;
  }
  return text;
}

std::string task_list(const std::vector<int>& tasks) {
  return (tasks.size() == 1 ? "task " : "tasks ") + array_text(tasks);
}

}  // namespace kaz::tools
