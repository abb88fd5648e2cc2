// Files that are put in place and removed.
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

TEST_F(Output, PutsAFileInThePlaceOfAnother) {
  write("new", "new");
  write("old", "old");
  ASSERT_TRUE(put_in_place(at("new"), at("old")));
  EXPECT_EQ(read("old"), "new");
  EXPECT_EQ(files(), 1u);
  EXPECT_FALSE(put_in_place(at("none"), at("old")));
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
  {
    FileRemover remover(at("kept"));
    remover.keep();
  }
  EXPECT_FALSE(fs::exists(at("gone")));
  EXPECT_TRUE(fs::exists(at("kept")));
}

}  // namespace
}  // namespace kaz::tools
