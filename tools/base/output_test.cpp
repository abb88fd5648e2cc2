// Files that are put in place and removed.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/output.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
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

TEST_F(Output, PutsAFileInThePlaceOfAnother) {
  write("new", "new");
  write("old", "old");
  ASSERT_TRUE(put_in_place(at("new"), at("old")));
  EXPECT_EQ(read("old"), "new");
  EXPECT_EQ(files(), 1u);
  EXPECT_FALSE(put_in_place(at("none"), at("old")));
  EXPECT_EQ(read("old"), "new");
}

// On a terminal a line is drawn over the last one, so none may be wider than the terminal.
TEST(ProgressOfABehavior, FitsIntoTheTerminal) {
  for (const unsigned short columns : {60, 80, 200}) {
    int terminal = -1, other = -1;
    const winsize size{24, columns, 0, 0};
    ASSERT_EQ(openpty(&terminal, &other, nullptr, nullptr, &size), 0);
    const int before = dup(STDERR_FILENO);
    dup2(other, STDERR_FILENO);
    {
      Progress progress("kaz vision run", false);
      progress.update(0.5, "a note that is rather longer than thirty-six characters");
    }
    {
      Progress progress("kaz run", false);
      progress.show(1234.5, "a phase that is rather longer than thirty-six characters");
    }
    dup2(before, STDERR_FILENO);
    close(before);
    close(other);
    char drawn[2000] = {};
    ASSERT_GT(read(terminal, drawn, sizeof drawn - 1), 0);
    close(terminal);
    std::string line;
    std::size_t longest = 0;
    for (const char* c = drawn; *c != 0; ++c) {
      if (*c == '\033')
        c += 2;  // erases the rest
      else if (*c == '\r' || *c == '\n')
        line.clear();
      else
        longest = std::max(longest, (line += *c).size());
    }
    EXPECT_LT(longest, columns) << drawn;
    EXPECT_GT(longest, 40u) << drawn;
  }
}

TEST(BrokenLines, GoOnDeeperAtSpaces) {
  EXPECT_EQ(broken_lines("a line of words\n", 0), "a line of words\n");
  EXPECT_EQ(broken_lines("a line of words\nand more\n", 10), "a line of\n  words\nand more\n");
  EXPECT_EQ(broken_lines("  two words\n", 8), "  two\n    words\n");
  EXPECT_EQ(broken_lines("oneverylongword\n", 8), "oneverylongword\n");
}

TEST(ListRow, GoesOnBelowItselfOrInLinesOfItsOwn) {
  EXPECT_EQ(list_row("name  ", "a text of many words", 0), "name  a text of many words\n");
  EXPECT_EQ(list_row("name  ", "a text of many words", 26), "name  a text of many words\n");
  EXPECT_EQ(list_row("name  ", "thirty columns are the least, and this is more", 40),
            "name  thirty columns are the least, and\n      this is more\n");
  EXPECT_EQ(list_row("a long name  ", "twelve columns of room", 25),
            "a long name\n      twelve columns of\n      room\n");
  EXPECT_EQ(list_row("n  ", "a-word-that-is-wider-than-all-the-columns-there-are and more", 35),
            "n  a-word-that-is-wider-than-all-the-columns-there-are\n   and more\n");
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

TEST(ProgressOfAShare, IsALineEveryTenPerCentAndAfterASilence) {
  testing::internal::CaptureStderr();
  {
    Progress seldom("kaz bench", false);
    for (const double share : {0.0, 0.05, 0.12, 0.17}) seldom.update(share, "trips");
    Progress often("kaz slow", false, std::chrono::milliseconds(0));
    for (const double share : {0.0, 0.05, 0.12, 0.17}) often.update(share, "trips");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "kaz bench   0 %  trips\nkaz bench  10 %  trips\n"
            "kaz slow   0 %  trips\nkaz slow   5 %  trips\nkaz slow  10 %  trips\n"
            "kaz slow  17 %  trips\n");
}

TEST_F(Output, RemoverRemovesItsFileAlone) {
  write("gone", "x");
  write("kept", "x");
  { const FileRemover remover(at("gone")); }
  { const FileRemover remover(""); }
  {
    FileRemover remover(at("kept"));
    remover.keep();
  }
  EXPECT_FALSE(fs::exists(at("gone")));
  EXPECT_TRUE(fs::exists(at("kept")));
}

}  // namespace
}  // namespace kaz::tools
