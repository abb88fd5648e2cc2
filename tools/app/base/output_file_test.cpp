// Single files of results: checked and locked at the start, in place at the end.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  File() : folder_(make_temporary_folder("kaz-file-").value()) {}
  ~File() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
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

TEST_F(File, StandsAtItsPlaceOnlyWhenItIsWhole) {
  std::ofstream(at("r.json")) << "old";
  auto file = OutputFile::open(at("r.json"), "--json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(read("r.json"), "old");
  std::ofstream(file->part()) << "new";
  EXPECT_EQ(read("r.json"), "old");
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read("r.json"), "new");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, LeavesNothingWithoutCommit) {
  { ASSERT_TRUE(OutputFile::open(at("r.json"), "--json")); }
  EXPECT_EQ(files(), 0u);
  {
    auto file = OutputFile::open(at("r.json"), "--json");
    ASSERT_TRUE(file->write("all"));
  }
  EXPECT_EQ(read("r.json"), "all");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, IsRefusedWhereItCannotBeCreated) {
  for (const std::string& path : {at("none/r.json"), std::string("/proc/r.json"), folder_}) {
    const auto file = OutputFile::open(path, "--junit");
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().fault, Fault::usage);
    EXPECT_EQ(file.error().message.find("--junit: '" + path + "'"), 0u) << file.error().message;
  }
}

TEST_F(File, TakesThePlaceOfAKilledRunsPart) {
  std::ofstream(at("r.json.part")) << "half of something";
  auto file = OutputFile::open(at("r.json"), "--json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(read("r.json.part"), "");
  ASSERT_TRUE(file->write("x"));
  EXPECT_EQ(read("r.json"), "x");
}

TEST_F(File, DoesNotFollowALinkInThePlaceOfItsPart) {
  std::ofstream(at("mine")) << "mine";
  fs::create_symlink(at("mine"), at("r.json.part"));
  EXPECT_FALSE(OutputFile::open(at("r.json"), "--json"));
  EXPECT_EQ(read("mine"), "mine");
}

TEST_F(File, FollowsALinkInItsPlace) {
  fs::create_symlink("elsewhere", at("r.json"));
  auto file = OutputFile::open(at("r.json"), "--json");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(file->write("x"));
  EXPECT_TRUE(fs::is_symlink(at("r.json")));
  EXPECT_EQ(read("elsewhere"), "x");
}

TEST_F(File, IsOfOneProcessAtATime) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t other = fork();
  if (other == 0) {
    const auto file = OutputFile::open(at("r.vcd"), "--vcd");
    char byte = file ? 'y' : 'n';
    (void)!::write(ready[1], &byte, 1);
    pause();
    _exit(0);
  }
  char byte = 'n';
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ASSERT_EQ(byte, 'y');
  {
    const auto file = OutputFile::open(at("r.vcd"), "--vcd");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().fault, Fault::environment);
    EXPECT_NE(file.error().message.find("another run"), std::string::npos) << file.error().message;
  }
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
  EXPECT_TRUE(OutputFile::open(at("r.vcd"), "--vcd"));
  close(ready[0]);
  close(ready[1]);
}

TEST_F(File, ADeviceTakesTheBytesItself) {
  auto sink = OutputFile::open("/dev/null", "--json");
  ASSERT_TRUE(sink) << sink.error().message;
  EXPECT_TRUE(sink->write("x"));
  auto full = OutputFile::open("/dev/full", "--json");
  ASSERT_TRUE(full) << full.error().message;
  const auto written = full->write("x");
  ASSERT_FALSE(written);
  EXPECT_TRUE(is_disk_full(written.error())) << written.error().message;
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace kaz::tools
