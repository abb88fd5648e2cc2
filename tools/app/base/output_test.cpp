// Folders of results: each file is whole or not there, and an old result does not outlive a new run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
 protected:
  Output() : folder_(make_temporary_folder("kaz-output-").value()) {}
  ~Output() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name)) << text;
  }
  std::string read(const std::string& name) const {
    std::ifstream file(at(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  std::string folder_;
};

TEST_F(Output, RemovesAnOldResultAndKeepsTheRest) {
  write("result.json", "old");
  write("notes.txt", "mine");
  const auto folder = OutputFolder::open(folder_);
  ASSERT_TRUE(folder);
  EXPECT_FALSE(fs::exists(at("result.json")));
  EXPECT_EQ(read("notes.txt"), "mine");
}

TEST_F(Output, MakesFoldersWithinFolders) {
  ASSERT_TRUE(OutputFolder::open(at("a/b/c")));
  EXPECT_TRUE(fs::is_directory(at("a/b/c")));
}

TEST_F(Output, IsRefusedWhereAFileIsInTheWay) {
  write("file", "x");
  EXPECT_FALSE(OutputFolder::check(at("file")));
  const auto folder = OutputFolder::open(at("file"));
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().fault, Fault::usage);
  EXPECT_EQ(read("file"), "x");
}

TEST_F(Output, CheckMakesNothing) {
  EXPECT_TRUE(OutputFolder::check(at("later")));
  EXPECT_TRUE(OutputFolder::check(""));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Output, LeavesOneWholeFileAndNoTemporaryOne) {
  const auto folder = OutputFolder::open(folder_);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->write_json("result.json", {{"seed", 1}}));
  ASSERT_TRUE(folder->write_json("result.json", {{"seed", 2}}));
  EXPECT_EQ(nlohmann::json::parse(read("result.json"))["seed"], 2);
  EXPECT_EQ(files(), 1u);
}

TEST_F(Output, KeepsTheOldFileWhereTheNewOneCannotBeWritten) {
  const auto folder = OutputFolder::open(folder_);
  ASSERT_TRUE(folder);
  EXPECT_FALSE(folder->write_json("missing/result.json", {{"seed", 1}}));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Output, WritesJsonOfTextThatIsNoUtf8) {
  const auto folder = OutputFolder::open(folder_);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->write_json("result.json", {{"text", "a\xff"}}));
  EXPECT_EQ(nlohmann::json::parse(read("result.json"))["text"], "a\xef\xbf\xbd");
}

TEST_F(Output, MovesAFileOverAnother) {
  write("new", "new");
  write("old", "old");
  ASSERT_TRUE(move_file(at("new"), at("old")));
  EXPECT_EQ(read("old"), "new");
  EXPECT_EQ(files(), 1u);
  EXPECT_FALSE(move_file(at("none"), at("old")));
  EXPECT_EQ(read("old"), "new");
}

// Standard error of a test is no terminal.
TEST(ProgressOfABehavior, IsItsPhaseAndItsTimeAndNoShare) {
  testing::internal::CaptureStderr();
  {
    Progress progress("kaz run", false);
    progress.announce(0.5, "search");
    for (const double at_s : {1.0, 5.0, 10.4, 10.6, 19.0, 20.7}) progress.show(at_s, "search");
    progress.announce(21, "walk");
    Progress quiet("kaz run", true);
    quiet.announce(1, "search");
    quiet.show(100, "search");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "kaz run: 0.50 s: search\nkaz run: 10.60 s: search\nkaz run: 20.70 s: search\n"
            "kaz run: 21.00 s: walk\n");
}

TEST_F(Output, RemoverRemovesItsFileAlone) {
  write("gone", "x");
  write("kept", "x");
  { const FileRemover remover(at("gone")); }
  { const FileRemover remover(""); }
  EXPECT_FALSE(fs::exists(at("gone")));
  EXPECT_TRUE(fs::exists(at("kept")));
}

}  // namespace
}  // namespace kaz::tools
