// Two runs compared: what was changed is found, another seed is no change, a run at a port can be read.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

struct CompareVerb : ::testing::Test {
  std::string walk(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"run",           "go-forward", "--set",
                                   "distance=0.05", "--out",      folder / name};
    words.insert(words.end(), more.begin(), more.end());
    const Finished finished = run(kaz(words), seconds(100));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return folder / name;
  }
  Finished compare(const std::string& a, const std::string& b,
                   const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"compare", a, b};
    words.insert(words.end(), more.begin(), more.end());
    return run(kaz(words));
  }
  static std::set<std::string> differing(const json& result) {
    std::set<std::string> names;
    for (const auto& measure : result["measures"])
      if (measure.value("differs", false)) names.insert(measure["name"]);
    return names;
  }
  TemporaryFolder folder;
};

TEST_F(CompareVerb, FindsAWeakerSupplyAndNoOtherSeed) {
  const std::string before = walk("before", {"--mcu", "native"});
  const std::string other = walk("other", {"--mcu", "native", "--seed", "2"});
  const std::string weaker = walk("weaker", {"--mcu", "native", "--seed", "3", "--supply", "8"});
  const Finished same = compare(before, other);
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  const Finished changed = compare(before, weaker, {"--json", "--out", folder / "difference"});
  EXPECT_EQ(changed.exit_code, 1) << changed.err;
  const auto names = differing(parse_json(changed.out));
  EXPECT_TRUE(names.contains("supply.mean")) << changed.out;
  EXPECT_FALSE(names.contains("link.round_trip")) << changed.out;
  for (const char* file : {"report.html", "result.json", "joints.svg", "link.svg"})
    EXPECT_GT(std::filesystem::file_size(folder / (std::string("difference/") + file)), 1000u)
        << file;
}

TEST_F(CompareVerb, ReadsARunAtAPortWhichCannotBeReplayed) {
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  const std::string port = walk("port", {"--robot", "serial:" + (folder / "board")});
  const std::string virtually = walk("virtual", {"--mcu", "native"});
  const Finished compared = compare(port, virtually, {"--json"});
  const json result = parse_json(compared.out);
  ASSERT_TRUE(result.is_object()) << compared.err;
  EXPECT_EQ(result["a"]["robot"], "serial:" + (folder / "board"));
  EXPECT_EQ(result["b"]["robot"], "virtual");
  EXPECT_NEAR(result["a"]["duration_s"].get<double>(), result["b"]["duration_s"].get<double>(),
              0.5);
  int both = 0;
  for (const auto& measure : result["measures"]) {
    const std::string name = measure["name"];
    both += measure.contains("differs") ? 1 : 0;
    // How late the machine is must not matter; the robot is the same.
    if (name.ends_with(".offset") || name.starts_with("supply.")) {
      EXPECT_FALSE(measure.value("differs", true)) << measure;
    }
  }
  EXPECT_GT(both, 40);
  const Finished replayed = run(kaz({"replay", port + "/recording.mcap"}));
  EXPECT_EQ(replayed.exit_code, 2);
  EXPECT_NE(replayed.err.find("recorded at the port serial:"), std::string::npos) << replayed.err;
}

TEST_F(CompareVerb, RefusesWhatIsNoRecordingOfARun) {
  write_file(folder / "text", "no recording");
  for (const auto& [name, says] :
       {std::pair{"none", "No such file"}, std::pair{"text", "not an MCAP file"}}) {
    const Finished refused = compare(folder / name, folder / name);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find(name), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(says), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace kaz::test
