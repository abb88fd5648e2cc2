// Single files of results: checked and locked at the start, in place at the end.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "shared/base/files.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/base/other_process_testing.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

const FileKind kReport{"report", {"report of", "kaz"}};

class File : public testing::Test {
 protected:
  File() : folder_(make_temporary_folder("kaz-file-").value()) {}
  ~File() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  Result<OutputFile> open(const std::string& name) const {
    return OutputFile::open(at(name), "--json", kReport);
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
  std::ofstream(at("r.json")) << "old report of kaz";
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(read("r.json"), "old report of kaz");
  std::ofstream(file->part()) << "new";
  EXPECT_EQ(read("r.json"), "old report of kaz");
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
    const auto waits = open("waits.json"), empty = open("empty.json"), grows = open("grows.json");
    auto done = open("done.json");
    if (!waits || !empty || !grows || !done || !done->write("all")) ::_exit(1);
    (void)empty->part();
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
    const auto file = OutputFile::open(path, "--junit", kReport);
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().fault, Fault::usage);
    EXPECT_EQ(file.error().message.find("--junit: '" + path + "'"), 0u) << file.error().message;
  }
}

TEST_F(File, TakesThePlaceOfAKilledRunsPart) {
  std::ofstream(at("r.json.part")) << "half of a report of kaz";
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

// What an earlier run wrote goes, and nothing else: neither a file nor one beside it.
TEST_F(File, ReplacesOnlyFilesOfItsKind) {
  const FileKind by_size{"memory", {}, 5}, never{"content of a flash"};
  const struct {
    const char* there;
    const FileKind& kind;
    bool replaced;
  } cases[] = {{"a report of kaz 1", kReport, true},
               {"", kReport, true},
               {"a report of others", kReport, false},
               {"notes", by_size, true},
               {"note", by_size, false},
               {"", never, true},
               {"a report of kaz 1", never, false}};
  for (const auto& one : cases) {
    for (const char* name : {"r.json", "r.json.part"}) {
      std::ofstream(at(name)) << one.there;
      {
        const auto file = OutputFile::open(at("r.json"), "--json", one.kind);
        EXPECT_EQ(file.has_value(), one.replaced) << one.there << ", " << one.kind.name;
        if (!file) {
          EXPECT_EQ(file.error().fault, Fault::usage);
          EXPECT_NE(file.error().message.find("exists"), std::string::npos) << file.error().message;
          EXPECT_EQ(read(name), one.there);
        }
      }
      fs::remove(at(name));
    }
  }
}

TEST_F(File, OfTwoOptionsIsRefused) {
  const auto first = open("r.json");
  fs::create_symlink(".", at("here"));
  const auto second = OutputFile::open(at("here/r.json"), "--junit", kReport);
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
  auto sink = OutputFile::open("/dev/null", "--json", kReport);
  ASSERT_TRUE(sink) << sink.error().message;
  EXPECT_TRUE(sink->write("x"));
  auto full = OutputFile::open("/dev/full", "--json", kReport);
  ASSERT_TRUE(full) << full.error().message;
  const auto written = full->write("x");
  ASSERT_FALSE(written);
  EXPECT_TRUE(is_disk_full(written.error())) << written.error().message;
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(File, LooksForRoomBeforeSomethingLongBegins) {
  auto file = open("r.json");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->check_room(1 << 17));
  const auto none = file->check_room(std::uint64_t{1} << 50);  // more than a disk has
  if (none) GTEST_SKIP() << "this file system does not say how much room it has";
  EXPECT_EQ(none.error().fault, Fault::environment);
  EXPECT_TRUE(is_disk_full(none.error())) << none.error().message;
  ASSERT_TRUE(file->write("report of kaz"));
  EXPECT_EQ(read("r.json"), "report of kaz");
  EXPECT_TRUE(OutputFile::open("/dev/null", "--json", kReport)->check_room(1 << 17));
}

}  // namespace
}  // namespace kaz::tools
