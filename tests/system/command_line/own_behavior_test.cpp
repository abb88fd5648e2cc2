// Behaviors from shared objects: examples/behavior in `kaz run`, `kaz evaluate` and `kaz replay`; refusals.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;

const std::string kModules = KAZ_PLUGINS;  // folder of the modules built for this test

Finished run_plugin(const std::string& path, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"run", path, "--world", "empty", "--mcu", "native"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(kaz(arguments));
}

TEST(OwnBehavior, RunsAndIsReplayed) {
  const TemporaryFolder folder;
  const std::string wave = kModules + "/wave.so";
  const Finished finished = run_plugin(wave, {"--set", "times=1", "--out", folder / "out"});
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["outcome"], "done");
  EXPECT_EQ(result["behavior"], wave);
  EXPECT_NE(finished.out.find("the robot has waved"), std::string::npos) << finished.out;
  EXPECT_NE(result.dump().find("outermost_rad"), std::string::npos) << result.dump(1);

  // A recording names no code to load.
  const std::string recording = folder / "out/recording.mcap";
  const Finished refused = run(kaz({"replay", recording}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("give the plug-in with --plugin FILE"), std::string::npos)
      << refused.err;
  const Finished again = run(kaz({"replay", recording, "--plugin", wave}));
  EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_NE(again.out.find("identical"), std::string::npos) << again.out;
}

TEST(OwnBehavior, TakesItsOptionsAndNoOthers) {
  const Finished wrong = run_plugin(kModules + "/wave.so", {"--set", "times=11"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("a whole number from 1 to 10"), std::string::npos) << wrong.err;
  const Finished unknown = run_plugin(kModules + "/wave.so", {"--set", "speed=1"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("its options are times"), std::string::npos) << unknown.err;
}

// Before anything moves: the arm's joints are on the channels of neck and left arm.
TEST(OwnBehavior, NamesTheJointsThatAnotherRobotLacks) {
  const Finished refused =
      run_plugin(kModules + "/wave.so", {"--robot-file", "sim/robots/arm/arm.urdf"});
  EXPECT_EQ(refused.exit_code, 2) << refused.out << refused.err;
  for (const char* text : {"wave moves r_sh_pitch, r_sh_roll, r_elbow", "has only turn, shoulder",
                           "use a behavior for this robot's joints, or `stand`"})
    EXPECT_NE(refused.err.find(text), std::string::npos) << text << "\n" << refused.err;
}

TEST(OwnBehavior, IsEvaluated) {
  const TemporaryFolder folder;
  const Finished finished =
      run(kaz({"evaluate", kModules + "/wave.so", "--set", "times=1", "--episodes", "1", "--mcu",
               "native", "--eyes", "ideal", "--out", folder / "out", "--json"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  EXPECT_NE(read_file(folder / "out/episodes/000000.json").find("the robot has waved"),
            std::string::npos);
}

// The program has and exports what the headers declare, not only what it calls itself.
TEST(OwnBehavior, MayCallEachLibrary) {
  const Finished finished = run_plugin(kModules + "/all_libraries.so", {"--set", "posture=keep"});
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  EXPECT_NE(finished.out.find("all of it is there"), std::string::npos) << finished.out;
}

// Each refusal is a usage error and one sentence: what, why, what to do.
TEST(OwnBehavior, RefusesWhatIsNoPlugin) {
  const TemporaryFolder folder;
  write_file(folder / "text.so",
             "not a program, but long enough to hold the header of an ELF file\n");
  std::filesystem::create_directory(folder / "folder.so");
  const struct {
    std::string path;
    std::vector<std::string> words;
  } cases[] = {
      {folder / "none.so", {"does not exist: build it"}},
      {"none.so", {"none.so does not exist"}},
      {folder / "folder.so", {"is not a file"}},
      {folder / "text.so", {"cannot be loaded as a shared object (", "invalid ELF header"}},
      {kModules + "/no_factory.so",
       {"does not export `kaz_behavior_plugin_v1`", "KAZ_BEHAVIOR_PLUGIN"}},
      {kModules + "/other_version.so",
       {"was built against another Kaz", "(headers of yesterday; this program: headers ",
        "rebuild it"}},
      {kModules + "/other_options.so", {"Eigen alignment 32", "Eigen alignment 16", "rebuild it"}},
      {kModules + "/missing_symbol.so",
       {"needs `kaz::host::gone_since(int)`, which this program does not have",
        "rebuild the plug-in"}},
      {kModules + "/no_function.so", {"has a behavior without a name or function"}},
  };
  for (const auto& [path, words] : cases) {
    const Finished refused = run_plugin(path);
    EXPECT_EQ(refused.exit_code, 2) << path << "\n" << refused.err;
    EXPECT_EQ(refused.err.find("kaz run: " + path), 0u) << refused.err;
    EXPECT_EQ(refused.err.find('\n'), refused.err.size() - 1) << "one sentence: " << refused.err;
    for (const std::string& text : words)
      EXPECT_NE(refused.err.find(text), std::string::npos) << text << "\n" << refused.err;
  }
}

TEST(OwnBehavior, TheHelpMentionsIt) {
  for (const char* verb : {"run", "evaluate"}) {
    const Finished help = run(kaz({verb, "--help"}));
    EXPECT_NE(help.out.find("./NAME.so"), std::string::npos) << verb;
  }
  const Finished unknown = run(kaz({"run", "dance"}));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("or the path of a plug-in (./NAME.so)"), std::string::npos)
      << unknown.err;
}

}  // namespace
}  // namespace kaz::test
