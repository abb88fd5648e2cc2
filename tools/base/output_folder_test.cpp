// Folders of results: locked, checked before a run, results of two runs never mixed.
// SPDX-License-Identifier: Apache-2.0
#include "shared/base/json_testing.h"

#include <sys/resource.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "tools/base/other_process_testing.h"
#include "tools/base/output_file.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;

const OutputKind kRun{"run", {"result.json", "moments.png", "*.vision.png"}};
const OutputKind kBench{"bench", {"result.json", "report.html"}};

class Folder : public testing::Test {
 protected:
  Folder() : folder_(make_temporary_folder("kaz-output-").value()) {}
  ~Folder() override {
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
  std::set<std::string> names(const std::string& below = ".") const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(at(below)))
      all.insert(entry.path().filename().string());
    return all;
  }
  // Leaves result.json and a picture.
  void earlier_run() const {
    const auto folder = OutputFolder::begin(folder_, kRun);
    ASSERT_TRUE(folder) << folder.error().message;
    ASSERT_TRUE(folder->write("result.json", "old"));
    ASSERT_TRUE(folder->write("7.vision.png", "old"));
  }
  std::string refusal(const OutputKind& kind, Fault fault = Fault::usage) const {
    const auto folder = OutputFolder::open(folder_, kind);
    if (folder) return "accepted";
    EXPECT_EQ(folder.error().fault, fault) << folder.error().message;
    EXPECT_NE(folder.error().message.find("--out"), std::string::npos) << folder.error().message;
    return folder.error().message;
  }
  std::string folder_;
};

TEST_F(Folder, ClearsResultsAndKeepsTheRest) {
  earlier_run();
  write("notes.txt", "mine");
  const auto folder = OutputFolder::open(folder_, kRun);
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(read("result.json"), "old") << "nothing goes before the run begins";
  ASSERT_TRUE(folder->clear());
  EXPECT_EQ(names(), (std::set<std::string>{".kaz-results", "notes.txt"}));
}

TEST_F(Folder, RefusesFilesThatNoMarkExplains) {
  write("moments.png", "mine");
  EXPECT_NE(refusal(kRun).find("'moments.png'"), std::string::npos) << refusal(kRun);
  fs::rename(at("moments.png"), at("1.vision.png"));
  EXPECT_NE(refusal(kRun).find("'1.vision.png'"), std::string::npos) << refusal(kRun);
  EXPECT_EQ(names(), (std::set<std::string>{"1.vision.png"})) << "a refusal leaves nothing";
  fs::rename(at("1.vision.png"), at("picture.png"));
  EXPECT_EQ(refusal(kRun), "accepted");
}

TEST_F(Folder, RefusesResultsOfAnotherKind) {
  earlier_run();
  EXPECT_NE(refusal(kBench).find("kaz run"), std::string::npos) << refusal(kBench);
  EXPECT_EQ(read("result.json"), "old");
  EXPECT_EQ(refusal(kRun), "accepted") << "the refused run has changed the mark";
  fs::remove(at("result.json"));
  fs::remove(at("7.vision.png"));
  EXPECT_EQ(refusal(kBench), "accepted");
}

TEST_F(Folder, IsOfOneProcessAtATime) {
  {
    const OtherProcess other([&] { return OutputFolder::begin(folder_, kRun); });
    ASSERT_TRUE(other.holds());
    const std::string why = refusal(kRun, Fault::environment);
    EXPECT_NE(why.find("process " + std::to_string(other.process())), std::string::npos) << why;
  }  // killed
  EXPECT_EQ(refusal(kRun), "accepted");
}

TEST_F(Folder, MakesFoldersThatGoWithARunThatLeavesNothing) {
  {
    const auto folder = OutputFolder::begin(at("a/b/c"), kRun);
    ASSERT_TRUE(folder) << folder.error().message;
    EXPECT_EQ(names("a/b/c"), (std::set<std::string>{".kaz-results"}));
  }
  EXPECT_FALSE(fs::exists(at("a")));
  {
    const auto folder = OutputFolder::begin(at("a/b/c"), kRun);
    ASSERT_TRUE(folder->write_json("result.json", {{"text", "a\xff"}}));
  }
  EXPECT_EQ(parse_json(read("a/b/c/result.json"))["text"], "a\xef\xbf\xbd");
  EXPECT_EQ(names("a/b/c"), (std::set<std::string>{".kaz-results", "result.json"}));
}

TEST_F(Folder, IsRefusedWhereNothingCanBeWritten) {
  write("file", "x");
  for (const std::string& path : {at("file"), at("file/below"), std::string("/proc/x")}) {
    const auto folder = OutputFolder::open(path, kRun);
    ASSERT_FALSE(folder) << path;
    EXPECT_EQ(folder.error().fault, Fault::usage);
    EXPECT_NE(folder.error().message.find(path), std::string::npos) << folder.error().message;
  }
  EXPECT_EQ(read("file"), "x");
}

TEST_F(Folder, TemporaryFilesOfAKilledRunGo) {
  earlier_run();
  write("result.json.part4711-0", "half");
  write("moments.png.part", "half");
  write("notes.txt.part", "mine");
  ASSERT_TRUE(OutputFolder::open(folder_, kRun));
  EXPECT_EQ(names(), (std::set<std::string>{".kaz-results", "7.vision.png", "notes.txt.part",
                                            "result.json"}));
}

TEST_F(Folder, AMarkOfAnEarlierVersionIsRead) {
  write("result.json", "old");
  write(".kaz-results", "kaz-results 1\nkind run\nprocess 7\nfile result.json\nfile a.p");
  EXPECT_NE(refusal(kBench), "accepted");
  ASSERT_TRUE(OutputFolder::begin(folder_, kRun));
  EXPECT_TRUE(names().empty());
}

TEST_F(Folder, AMarkThatIsNotOursIsRefusedAndStays) {
  for (const char* text : {"something else\n", "kaz-results 2\nkind run\n"}) {
    write(".kaz-results", text);
    EXPECT_NE(refusal(kRun), "accepted") << text;
    EXPECT_EQ(read(".kaz-results"), text);
  }
  fs::remove(at(".kaz-results"));
  write("mine", "");
  fs::create_symlink(at("mine"), at(".kaz-results"));
  EXPECT_NE(refusal(kRun), "accepted");
  EXPECT_EQ(read("mine"), "");
}

TEST_F(Folder, ALinkGoesItselfAndAFolderStays) {
  earlier_run();
  write("mine", "mine");
  fs::remove(at("result.json"));
  fs::create_symlink(at("mine"), at("result.json"));
  ASSERT_TRUE(OutputFolder::begin(folder_, kRun));
  EXPECT_FALSE(fs::is_symlink(at("result.json")));
  EXPECT_EQ(read("mine"), "mine");
  earlier_run();
  fs::create_directories(at("moments.png/mine"));
  EXPECT_FALSE(OutputFolder::begin(folder_, kRun));
  EXPECT_TRUE(fs::exists(at("moments.png/mine")));
}

// A limit of size is met as a full disk is.
TEST_F(Folder, AFullDiskIsNamedWithWhatIsSaved) {
  const auto folder = OutputFolder::begin(folder_, kRun);
  ASSERT_TRUE(folder);
  ASSERT_TRUE(folder->write("moments.png", "small"));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 8192;
  setrlimit(RLIMIT_FSIZE, &small);
  const auto written = folder->write("result.json", std::string(10'000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, Fault::environment);
  EXPECT_TRUE(written.error().disk_full);
  const std::string message = with_saved_files(written.error()).message;
  EXPECT_NE(message.find(at("result.json")), std::string::npos) << message;
  EXPECT_NE(message.find(at("moments.png")), std::string::npos) << message;
  EXPECT_EQ(names(), (std::set<std::string>{".kaz-results", "moments.png"}));
}

}  // namespace
}  // namespace kaz::tools
