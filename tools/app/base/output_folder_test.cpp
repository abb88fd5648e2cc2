// Folders of results: locked, checked before a run, results of two runs never mixed.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/output_folder.h"
#include "shared/base/json_testing.h"

#include <sys/resource.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tools/app/base/other_process_testing.h"
#include "tools/app/base/output_list.h"

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
    ASSERT_TRUE(folder->add("7.vision.png"));
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

TEST_F(Folder, ClearsListedResultsAndKeepsTheRest) {
  earlier_run();
  write("notes.txt", "mine");
  const auto folder = OutputFolder::open(folder_, kRun);
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(read("result.json"), "old") << "nothing goes before the run begins";
  ASSERT_TRUE(folder->clear());
  EXPECT_EQ(names(), (std::set<std::string>{".kaz-results", "notes.txt"}));
}

TEST_F(Folder, RefusesFilesThatNoListNames) {
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
  EXPECT_NE(refusal(kBench).find("results of kaz run"), std::string::npos) << refusal(kBench);
  EXPECT_EQ(read("result.json"), "old");
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

// Of a list that its run could not finish the last line is missing.
TEST_F(Folder, AListThatWasCutOffIsRead) {
  earlier_run();
  { std::ofstream(at(".kaz-results"), std::ios::app) << "file 8.visi"; }
  {
    const auto folder = OutputFolder::open(folder_, kRun);
    ASSERT_TRUE(folder) << folder.error().message;
    ASSERT_TRUE(folder->add("9.vision.png"));
  }
  const auto list = parse_output_list(read(".kaz-results"), "list");
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_TRUE(list->names.contains("9.vision.png"));
}

TEST_F(Folder, AListThatIsNoneOrALinkIsRefused) {
  write(".kaz-results", "something else\n");
  EXPECT_NE(refusal(kRun).find("line 1"), std::string::npos);
  EXPECT_EQ(read(".kaz-results"), "something else\n");
  fs::remove(at(".kaz-results"));
  write("mine", "");
  fs::create_symlink(at("mine"), at(".kaz-results"));
  EXPECT_NE(refusal(kRun), "accepted");
  EXPECT_EQ(read("mine"), "");
}

// Of another version, or with names of other folders: neither read nor followed.
TEST_F(Folder, AListThatIsNotOursRemovesNothing) {
  const std::string outside = folder_ + "-mine";
  std::ofstream(outside) << "mine";
  const std::string name = fs::path(outside).filename().string();
  for (const std::string& list : {std::string("kaz-results 2\nkind run\nfile x\n"),
                                  "kaz-results 1\nkind run\nfile ../" + name + "\n",
                                  "kaz-results 1\nkind run\nfile " + outside + "\n"}) {
    write(".kaz-results", list);
    EXPECT_NE(refusal(kRun), "accepted") << list;
    EXPECT_EQ(read(".kaz-results"), list);
  }
  // A listed link goes itself; a listed folder is no result.
  fs::create_symlink(outside, at("result.json"));
  write(".kaz-results", "kaz-results 1\nkind run\nfile result.json\n");
  EXPECT_TRUE(OutputFolder::begin(folder_, kRun));
  EXPECT_FALSE(fs::is_symlink(at("result.json")));
  fs::create_directories(at("moments.png/mine"));
  write(".kaz-results", "kaz-results 1\nkind run\nfile moments.png\n");
  EXPECT_FALSE(OutputFolder::begin(folder_, kRun));
  EXPECT_TRUE(fs::exists(at("moments.png/mine")));
  EXPECT_TRUE(fs::exists(outside));
  fs::remove(outside);
}

TEST_F(Folder, NamesAreOfTheFolderItself) {
  const auto folder = OutputFolder::begin(folder_, kRun);
  ASSERT_TRUE(folder);
  for (const char* name : {"", "..", "a/b", "a\nb", ".kaz-results"})
    EXPECT_FALSE(folder->add(name)) << name;
  write("mine.png", "mine");
  EXPECT_FALSE(folder->add("mine.png"));
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
  const auto written = folder->explained(folder->write("result.json", std::string(10'000, 'x')));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, Fault::environment);
  EXPECT_EQ(written.error().message.find("disk full while writing " + at("result.json")), 0u)
      << written.error().message;
  EXPECT_NE(written.error().message.find("saved so far in '" + folder_ + "': moments.png"),
            std::string::npos)
      << written.error().message;
  EXPECT_EQ(names(), (std::set<std::string>{".kaz-results", "moments.png"}));
}

TEST(OutputList, IsReadBackAsItWasWritten) {
  const OutputList list{"bench fit", 12, {"a", "b c.png", "result.json"}};
  const auto read = parse_output_list(output_list_text(list), "list");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, list);
  EXPECT_EQ(parse_output_list("", "list").value(), OutputList{});
}

TEST(OutputList, RefusesWhatIsNoListOfThisFolder) {
  for (const char* line : {"file ../x", "file ..", "file /etc/passwd", "file ", "file .kaz-results",
                           "kind Run", "kind run", "process -1", "process 1x", "x"}) {
    const auto list =
        parse_output_list("kaz-results 1\nkind run\n" + std::string(line) + "\n", "here/list");
    ASSERT_FALSE(list) << line;
    EXPECT_EQ(list.error().fault, Fault::usage);
    EXPECT_NE(list.error().message.find("here/list: line 3"), std::string::npos)
        << list.error().message;
  }
  EXPECT_FALSE(parse_output_list("kaz-results 1\nfile a\n", "list"));
  EXPECT_FALSE(parse_output_list(std::string(kMaxOutputListBytes + 1, '\n'), "list"));
}

}  // namespace
}  // namespace kaz::tools
