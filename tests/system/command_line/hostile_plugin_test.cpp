// Plug-ins that throw, crash, never return, or return nonsense.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <ostream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::seconds;

const std::string kModules = KAZ_PLUGINS;
const std::string kHostile = kModules + "/hostile.so";

std::vector<std::string> run_plugin(const std::string& path, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run", path, "--world", "empty", "--mcu", "native"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return kaz(arguments);
}

// A fault of a plug-in and the texts of its message.
struct Misdeed {
  std::string does;
  std::vector<std::string> words;
};
void PrintTo(const Misdeed& misdeed, std::ostream* out) {
  *out << misdeed.does;
}

const Misdeed kMisdeeds[] = {
    {"throw", {" threw std::runtime_error: no more"}},
    {"throw-int", {" threw int"}},
    {"no-option", {" threw std::out_of_range", "no option `times` that is a number"}},
    {"wrong-kind", {" threw std::out_of_range", "no option `does` that is a number"}},
};

class Misdeeds : public ::testing::TestWithParam<Misdeed> {};

TEST_P(Misdeeds, EndTheRunInOrder) {
  const auto& [does, words] = GetParam();
  const TemporaryFolder folder;
  const Finished end =
      run(run_plugin(kHostile, {"--set", "does=" + does, "--out", folder / "out"}));
  EXPECT_EQ(end.exit_code, 1) << end.out << end.err;
  for (const std::string& text : words)
    EXPECT_NE(end.err.find(text), std::string::npos) << text << "\n" << end.err;
  EXPECT_NE(end.err.find("kaz run: " + kHostile), std::string::npos) << end.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  ASSERT_TRUE(result.is_object()) << end.err;
  EXPECT_EQ(result["outcome"], "failed");
  EXPECT_EQ(result["cause"], "crashed");
  EXPECT_NE(result["sentence"].get<std::string>().find(words[0]), std::string::npos) << result;
  EXPECT_TRUE(read_file(folder / "out/recording.mcap").ends_with("MCAP0\r\n"));
  EXPECT_FALSE(fs::exists(folder / "out/recording.mcap.part"));
}

TEST_P(Misdeeds, AreCountedAsTheProgramsError) {
  const auto& [does, words] = GetParam();
  const TemporaryFolder folder;
  const Finished end = run(kaz({"evaluate", kHostile, "--set", "does=" + does, "--episodes", "1",
                                "--mcu", "native", "--eyes", "ideal", "--out", folder / "out"}));
  EXPECT_EQ(end.exit_code, 1) << end.out << end.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  ASSERT_TRUE(result.is_object()) << end.err;
  EXPECT_EQ(result["failures"], json({{"crashed", {0}}})) << result.dump(1);
  EXPECT_TRUE(result["environment"].empty());
  const json episode = parse_json(read_file(folder / "out/episodes/000000.json"));
  EXPECT_NE(episode.value("sentence", "").find(words[0]), std::string::npos) << episode;
  EXPECT_GT(episode.value("seconds", 0.0), 0.1) << episode;
  EXPECT_TRUE(fs::exists(folder / "out/failures/000000/recording.mcap"));
}

INSTANTIATE_TEST_SUITE_P(All, Misdeeds, ::testing::ValuesIn(kMisdeeds), [](const auto& row) {
  std::string name = row.param.does;
  std::ranges::replace(name, '-', '_');
  return name;
});

// A crash ends the program. An evaluation runs each episode in its own process, and counts the crash.
TEST(HostilePlugin, CrashesAreCountedAsTheProgramsError) {
  for (const auto& [does, signal] :
       {std::pair("crash", SIGSEGV), std::pair("abort", SIGABRT), std::pair("overflow", SIGSEGV),
        std::pair("thread-throw", SIGABRT)}) {
    const Finished end = run(run_plugin(kHostile, {"--set", std::string("does=") + does}));
    EXPECT_EQ(end.exit_code, 128 + signal) << does << end.out << end.err;
  }
  for (const char* does : {"crash", "exit"}) {
    const TemporaryFolder folder;
    const Finished end =
        run(kaz({"evaluate", kHostile, "--set", std::string("does=") + does, "--episodes", "1",
                 "--mcu", "native", "--eyes", "ideal", "--out", folder / "out"}));
    EXPECT_EQ(end.exit_code, 1) << end.out << end.err;
    const json result = parse_json(read_file(folder / "out/result.json"));
    EXPECT_EQ(result["failures"], json({{"crashed", {0}}})) << result.dump(1);
  }
}

// The second Ctrl-C ends a plug-in that never returns.
TEST(HostilePlugin, ThatNeverReturnsEndsAtTheSecondSignal) {
  Process program(run_plugin(kHostile, {"--set", "does=loop"}));
  ASSERT_TRUE(program.wait_for_output("now", seconds(30))) << program.wait(seconds(0)).err;
  program.signal(SIGINT);
  std::this_thread::sleep_for(seconds(1));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(seconds(30)).exit_code, 130);
}

TEST(HostilePlugin, ThatNeverReturnsEndsWithItsEvaluation) {
  const TemporaryFolder folder;
  Process program(kaz({"evaluate", kHostile, "--set", "does=loop", "--episodes", "2", "--mcu",
                       "native", "--eyes", "ideal", "--out", folder / "out"}));
  std::this_thread::sleep_for(seconds(3));
  program.signal(SIGINT);
  const Finished end = program.wait(seconds(30));
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_EQ(parse_json(read_file(folder / "out/result.json"))["episodes"], 0);
}

// Results that make no sense are completed or refused.
TEST(HostilePlugin, ReturnsNonsense) {
  const struct {
    std::string does;
    int status;
    std::string words;
  } cases[] = {
      {"empty", 1, "returned an outcome without a sentence"},
      {"no-sentence", 1, "returned an error without a message"},
      {"interrupted", 1, "interrupted"},
      {"no-text", 1, "failed: "},
      {"nan", 1, "neck_pan was not moved: its target of nan degrees"},
      {"nothing", 0, "nothing was done"},
  };
  for (const auto& [does, status, words] : cases) {
    const TemporaryFolder folder;
    const Finished end =
        run(run_plugin(kHostile, {"--set", "does=" + does, "--out", folder / "out"}));
    EXPECT_EQ(end.exit_code, status) << does << "\n" << end.out << end.err;
    EXPECT_NE((end.out + end.err).find(words), std::string::npos) << does << end.out << end.err;
    const Finished counted =
        run(kaz({"evaluate", kHostile, "--set", "does=" + does, "--episodes", "1", "--mcu",
                 "native", "--eyes", "ideal", "--out", folder / "ten"}));
    EXPECT_EQ(counted.exit_code, status == 0 ? 0 : 1) << does << "\n" << counted.err;
    EXPECT_TRUE(parse_json(read_file(folder / "ten/result.json"))["environment"].empty()) << does;
  }
}

TEST(HostilePlugin, BreaksAReplay) {
  const TemporaryFolder folder;
  const Finished recorded =
      run(run_plugin(kHostile, {"--set", "does=nothing", "--out", folder / "out"}));
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  for (const char* mode : {"--host", "--whole"}) {
    for (const auto& [does, words] : kMisdeeds) {
      const Finished end = run(kaz({"replay", folder / "out/recording.mcap", mode, "--plugin",
                                    kHostile, "--set", "does=" + does}));
      EXPECT_EQ(end.exit_code, 1) << mode << does << end.out << end.err;
      EXPECT_NE(end.err.find("kaz replay: " + kHostile + words[0]), std::string::npos) << end.err;
    }
  }
}

// Loading it runs its code, too.
TEST(HostilePlugin, IsRefusedWhileItIsLoaded) {
  const struct {
    const char* name;
    std::string words;
  } cases[] = {
      {"registration", " threw std::logic_error: not today while it was loaded"},
      {"kaz_name", " has a behavior named `stand`, which is the name of a built-in behavior"},
      {"wrong_default", " has an option with a wrong default: `11` is not a value"},
  };
  for (const auto& [name, words] : cases) {
    const std::string path = kModules + "/" + name + ".so";
    const TemporaryFolder folder;
    for (const auto& command :
         {run_plugin(path, {"--out", folder / "out"}),
          kaz({"evaluate", path, "--episodes", "1", "--out", folder / "out"})}) {
      const Finished end = run(command);
      EXPECT_EQ(end.exit_code, 2) << path << "\n" << end.err;
      EXPECT_NE(end.err.find(words), std::string::npos) << words << "\n" << end.err;
      EXPECT_FALSE(fs::exists(folder / "out"));
    }
  }
}

TEST(HostilePlugin, AnotherMachinesFileIsNamed) {
  const TemporaryFolder folder;
  std::string other = read_file(kHostile);
  ASSERT_GT(other.size(), 20u);
  other[18] = static_cast<char>(other[18] ^ 0x80);  // e_machine
  write_file(folder / "other.so", other);
  const Finished end = run(run_plugin(folder / "other.so", {}));
  EXPECT_EQ(end.exit_code, 2);
  EXPECT_NE(end.err.find("is for another machine type (64-bit "), std::string::npos) << end.err;
}

TEST(HostilePlugin, AnExceptionSwitchesTheMotorsOfABoardOff) {
  const TemporaryFolder folder;
  Process simulator(
      kaz({"sim", "--world", "empty", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(simulator.wait_for_output("ready", seconds(30)));
  const Finished end = run(kaz({"run", kHostile, "--set", "does=throw", "--robot",
                                "serial:" + (folder / "board"), "--out", folder / "out"}));
  EXPECT_EQ(end.exit_code, 1) << end.err;
  const Finished status = run(kaz({"status", "--port", folder / "board", "--json"}));
  EXPECT_NE(status.out.find("\"motors\": \"off"), std::string::npos) << status.out;
}

TEST(HostilePlugin, ItsOptionsAreListed) {
  const Finished listed = run(kaz({"run", kModules + "/wave.so", "--options"}));
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_NE(listed.out.find("wave: raise the right arm and wave"), std::string::npos) << listed.out;
  EXPECT_NE(listed.out.find("times (3; 1 to 10): how often it waves"), std::string::npos)
      << listed.out;
}

}  // namespace
}  // namespace kaz::test
