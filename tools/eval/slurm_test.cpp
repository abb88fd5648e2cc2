// The job array of an evaluation: its words, its script, tasks that run twice.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/slurm.h"

#include "tools/eval/hosts.h"
#include "tools/eval/tasks.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

TEST(Slurm, TasksRepeatAllButWhatIsTheArrays) {
  EXPECT_EQ(task_words({"evaluate", "stand", "--slurm", "10", "--episodes", "100", "--out", "a b",
                        "--sbatch=--time=3", "--parallel-hosts", "h", "--parallel-tasks=4", "--set",
                        "seconds=3", "--json", "--jobs=2"}),
            (Words{"evaluate", "stand", "--episodes", "100", "--set", "seconds=3", "--jobs=2"}));
}

TEST(Slurm, AnArrayNamesItsTasksByRanges) {
  EXPECT_EQ(array_text({1, 2, 3, 7}), "1-3,7");
  EXPECT_EQ(array_text({4}), "4");
  EXPECT_EQ(array_text({1, 3, 5, 6}), "1,3,5-6");
}

TEST(Slurm, AnOutputFilesNameHasNoSymbolOfTheFoldersName) {
  EXPECT_EQ(slurm_pattern("/runs/100%j/%%/"), "/runs/100%%j/%%%%/");
}

// Neither shell nor parallel may find anything in the folder's name. In a file it ends with a NUL.
TEST(Hosts, ACommandIsOneShellWordForTheScript) {
  EXPECT_EQ(hosts_commands("/a b;touch X;'{}/task.sh", {1, 12}),
            std::string("sh '/a b;touch X;'\\''{}/task.sh' 1\0"
                        "sh '/a b;touch X;'\\''{}/task.sh' 12\0",
                        71));
}

// A folder with a program in place of kaz, and the script that runs it.
class SlurmScript : public testing::Test {
 protected:
  SlurmScript() : folder_(make_temporary_folder("kaz-slurm-").value()) {
    fs::create_directories(folder_ + "/parts");
    // Writes its words and leaves a result; its status is in the file `status`.
    write("kaz program",
          "#!/bin/sh\nfor out; do :; done\nmkdir -p \"$out\"\necho \"$@\" > \"$out/words\"\n"
          "echo x >> " +
              folder_ + "/runs\necho {} > \"$out/result.json\"\nexit $(cat " + folder_ +
              "/status)\n");
    fs::permissions(folder_ + "/kaz program", fs::perms::owner_all);
    write("status", "0");
    write("job.sh", slurm_script(folder_ + "/kaz program", {"evaluate", "stand", "--set", "a=b c"},
                                 folder_, 3, 2));
  }
  ~SlurmScript() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(write_whole_file(folder_ + "/" + name, text));
  }
  std::string read(const std::string& name) {
    return read_whole_file(folder_ + "/" + name, 10000).value_or("");
  }
  int task(int number, const std::string& more = "") {
    return std::system(("SLURM_JOB_ID=5 SLURM_ARRAY_TASK_ID=" + std::to_string(number) + " " +
                        more + " sh " + folder_ + "/job.sh")
                           .c_str());
  }
  std::size_t folders() {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_ + "/parts")) ++count;
    return count;
  }
  const std::string folder_;
};

TEST_F(SlurmScript, ATaskLeavesItsPartUnderItsNumber) {
  EXPECT_EQ(task(2), 0);
  EXPECT_EQ(folders(), 1u);
  const std::string words = read("parts/2/words");
  EXPECT_EQ(words.find("evaluate stand --set a=b c --shard 2/3 --out " + folder_ + "/parts/2."), 0u)
      << words;
  EXPECT_NE(read("job.sh").find("#SBATCH --cpus-per-task=2\n"), std::string::npos);
}

TEST_F(SlurmScript, OfParallelHostsHasItsNumberAsArgument) {
  write("job.sh", hosts_script(folder_ + "/kaz program", {"evaluate"}, folder_, 3));
  EXPECT_EQ(std::system(("sh " + folder_ + "/job.sh 3").c_str()), 0);
  EXPECT_EQ(read("parts/3/words").find("evaluate --shard 3/3 --out " + folder_ + "/parts/3."), 0u);
}

TEST_F(SlurmScript, OneThatHasItsPartDoesNothing) {
  EXPECT_EQ(task(1), 0);
  EXPECT_EQ(task(1, "SLURM_RESTART_COUNT=1"), 0);
  EXPECT_EQ(read("runs"), "x\n");
}

// Its node was given up, and yet both ran to their end: the second finds the first's part.
TEST_F(SlurmScript, OfTwoThatRunAtTheSameTimeOneLeavesAPart) {
  write("kaz program", "#!/bin/sh\nfor out; do :; done\nmkdir -p \"$out\"\nsleep 0.5\necho x >> " +
                           folder_ + "/runs\necho {} > \"$out/result.json\"\n");
  fs::permissions(folder_ + "/kaz program", fs::perms::owner_all);
  const std::string one = "SLURM_JOB_ID=5 SLURM_ARRAY_TASK_ID=1 sh " + folder_ + "/job.sh";
  EXPECT_EQ(std::system((one + " & SLURM_RESTART_COUNT=1 " + one + "; wait").c_str()), 0);
  EXPECT_EQ(read("runs"), "x\nx\n");
  EXPECT_EQ(folders(), 1u);
  EXPECT_TRUE(fs::exists(folder_ + "/parts/1/result.json"));
}

// Only folders that a task of this evaluation makes are removed, whatever else is in DIR/parts.
TEST_F(SlurmScript, OfTheUnfinishedOnlyWorkFoldersAreRemoved) {
  write("kaz program", "#!/bin/sh\nfor out; do :; done\nmkdir -p \"$out\"\nexit 3\n");
  fs::permissions(folder_ + "/kaz program", fs::perms::owner_all);
  EXPECT_NE(task(2), 0);
  EXPECT_EQ(folders(), 1u);
  const Words others{
      "readme.txt",      "my.notes",          "1",          "1.backup", "1.2024",
      "01.work.5",       "4.work.5",          "0.work.5",   ".work.5",  "-1.work.5.6",
      "1.work.",         "+2.work.7",         "1x.work.5",  "1.workx",  "12.work.1.2",
      "3.work.my-notes", "3.work.my notes.7", "3.work.v1.x"};
  for (const auto& name : others) fs::create_directories(folder_ + "/parts/" + name);
  write("parts/3.work.5", "a file, no folder");
  fs::create_directory_symlink(folder_ + "/parts/1", folder_ + "/parts/3.work.6");
  remove_unfinished(folder_, 3);
  EXPECT_EQ(folders(), others.size() + 2);
}

TEST_F(SlurmScript, NoEpisodeThatSucceededIsAResultAndATroubleIsNone) {
  write("status", "1");
  EXPECT_EQ(task(1), 0);
  EXPECT_TRUE(fs::exists(folder_ + "/parts/1/result.json"));
  write("status", "3");
  EXPECT_NE(task(2), 0);
  EXPECT_FALSE(fs::exists(folder_ + "/parts/2"));
}

}  // namespace
}  // namespace kaz::tools
