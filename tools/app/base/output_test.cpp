// Files that are moved and removed.
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

TEST_F(Output, MovesAFileOverAnother) {
  write("new", "new");
  write("old", "old");
  ASSERT_TRUE(move_file(at("new"), at("old")));
  EXPECT_EQ(read("old"), "new");
  EXPECT_EQ(files(), 1u);
  EXPECT_FALSE(move_file(at("none"), at("old")));
  EXPECT_EQ(read("old"), "new");
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
