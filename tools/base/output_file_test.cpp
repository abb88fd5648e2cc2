// Single files of results: checked and locked at the start, in place at the end.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/output_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "shared/base/files.hpp"
#include "tools/base/interrupt_signals.h"
#include "tools/base/other_process_testing.h"

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
  Result<OutputFile> open(const std::string& name) const {
    return OutputFile::open(at(name), "--json");
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
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(read("r.json"), "old");
  std::ofstream(file->part()) << "new";
  EXPECT_EQ(read("r.json"), "old");
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read("r.json"), "new");
  EXPECT_EQ(files(), 1u);
}

// One Ctrl-C where nothing waits for it, a second one elsewhere: what has grown is of use, an empty file not.
TEST_F(File, LeavesNoEmptyFileWhereASignalEndsTheProgramAtOnce) {
  const pid_t child = ::fork();
  if (child == 0) {
    InterruptSignals::forget_earlier();
    catch_signals();
    const auto empty = open("empty.json"), grows = open("grows.json");
    auto done = open("done.json");
    if (!empty || !grows || !done || !done->write("all")) ::_exit(1);
    std::ofstream(grows->part()) << "a first part" << std::flush;
    ::raise(SIGINT);
    ::_exit(2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(read("done.json"), "all");
  EXPECT_EQ(read("grows.json.part"), "a first part");
  EXPECT_EQ(files(), 2u);
}

TEST_F(File, LeavesNothingWithoutCommit) {
  { ASSERT_TRUE(open("r.json")); }
  EXPECT_EQ(files(), 0u);
  {
    auto file = open("r.json");
    ASSERT_TRUE(file->write("all"));
  }
  EXPECT_EQ(read("r.json"), "all");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, IsRefusedWhereItCannotBeCreated) {
  for (const std::string& path :
       {at("none/r.json"), std::string("/proc/r.json"), folder_, std::string()}) {
    const auto file = OutputFile::open(path, "--junit");
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().fault, Fault::usage);
    EXPECT_EQ(file.error().message.find("--junit: '" + path + "'"), 0u) << file.error().message;
  }
}

TEST_F(File, TakesThePlaceOfAKilledRunsPart) {
  std::ofstream(at("r.json.part")) << "half";
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(read("r.json.part"), "");
  ASSERT_TRUE(file->write("x"));
  EXPECT_EQ(read("r.json"), "x");
}

TEST_F(File, DoesNotFollowALinkInThePlaceOfItsPart) {
  std::ofstream(at("mine")) << "mine";
  fs::create_symlink(at("mine"), at("r.json.part"));
  EXPECT_FALSE(open("r.json"));
  EXPECT_EQ(read("mine"), "mine");
  fs::remove(at("r.json.part"));
  fs::create_hard_link(at("mine"), at("r.json.part"));
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(file->write("x"));
  EXPECT_EQ(read("mine"), "mine");
}

TEST_F(File, FollowsALinkInItsPlace) {
  fs::create_symlink("elsewhere", at("r.json"));
  EXPECT_FALSE(open("r.json")) << "a link to nothing";
  std::ofstream(at("elsewhere"));
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(file->write("x"));
  EXPECT_TRUE(fs::is_symlink(at("r.json")));
  EXPECT_EQ(read("elsewhere"), "x");
}

TEST_F(File, IsOfOneProcessAtATime) {
  {
    const OtherProcess other([&] { return open("r.vcd"); });
    ASSERT_TRUE(other.holds());
    const auto file = open("r.vcd");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().fault, Fault::environment);
    EXPECT_NE(file.error().message.find("another run (process " + std::to_string(other.process())),
              std::string::npos)
        << file.error().message;
  }  // killed
  EXPECT_TRUE(open("r.vcd"));
}

TEST_F(File, ReplacesAFileUnlessItIsToBeKept) {
  const auto reopened = [this](Existing existing) {
    return OutputFile::open(at("r.json"), "--json", existing).has_value();
  };
  EXPECT_TRUE(reopened(Existing::keep)) << "a new file";
  std::ofstream(at("r.json")) << "";
  EXPECT_TRUE(reopened(Existing::keep)) << "an empty file";
  std::ofstream(at("r.json")) << "mine";
  EXPECT_TRUE(reopened(Existing::replace));
  EXPECT_EQ(read("r.json"), "mine") << "not before the new file is complete";
  const auto kept = OutputFile::open(at("r.json"), "--json", Existing::keep);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().fault, Fault::usage);
  EXPECT_EQ(read("r.json"), "mine");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, OfTwoOptionsIsRefused) {
  const auto first = open("r.json");
  fs::create_symlink(".", at("here"));
  const auto second = OutputFile::open(at("here/r.json"), "--junit");
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("another option"), std::string::npos)
      << second.error().message;
}

TEST_F(File, IsRefusedAmongTheResultsOfARun) {
  fs::create_directory(at("out"));
  std::ofstream(at("out/.kaz-results")) << "kaz-results 1\n";
  const auto file = open("out/r.json");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("results of a run"), std::string::npos)
      << file.error().message;
}

TEST_F(File, APipeIsWrittenWhereItIsRead) {
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  const auto unread = open("pipe");
  ASSERT_FALSE(unread);
  EXPECT_NE(unread.error().message.find("no program reads"), std::string::npos)
      << unread.error().message;
  const int reader = ::open(at("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  auto file = open("pipe");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_TRUE(file->write("all"));
  char bytes[8] = {};
  EXPECT_EQ(::read(reader, bytes, sizeof bytes), 3);
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(at("pipe")));
}

TEST_F(File, ADeviceTakesTheBytesItself) {
  auto sink = OutputFile::open("/dev/null", "--json");
  ASSERT_TRUE(sink) << sink.error().message;
  EXPECT_TRUE(sink->write("x"));
  auto full = OutputFile::open("/dev/full", "--json");
  ASSERT_TRUE(full) << full.error().message;
  const auto written = full->write("x");
  ASSERT_FALSE(written);
  EXPECT_TRUE(written.error().disk_full) << written.error().message;
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// A limit of size is met as a full disk is.
TEST_F(File, AFullDiskIsAnErrorThatNamesWhatIsSaved) {
  auto done = open("done.json"), file = open("r.json");
  ASSERT_TRUE(done && file && done->write("all"));
  EXPECT_TRUE(file->check_room(1 << 17));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 8192;
  setrlimit(RLIMIT_FSIZE, &small);
  const auto room = file->check_room(1 << 17);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(room);
  EXPECT_EQ(room.error().fault, Fault::environment);
  EXPECT_TRUE(room.error().disk_full);
  const std::string message = with_saved_files(room.error()).message;
  EXPECT_NE(message.find(at("r.json")), std::string::npos) << message;
  EXPECT_NE(message.find(at("done.json")), std::string::npos) << message;
  ASSERT_TRUE(file->write("all"));
  EXPECT_EQ(read("r.json"), "all") << "the test has left bytes";
  EXPECT_TRUE(OutputFile::open("/dev/null", "--json")->check_room(1 << 17));
  const Error other{Fault::failed, "other"};
  EXPECT_EQ(with_saved_files(other).message, "other");
}

}  // namespace
}  // namespace kaz::tools
