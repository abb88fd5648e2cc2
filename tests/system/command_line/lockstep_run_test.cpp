// The demo in lockstep: it does its job, and the same seed gives the same bytes.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;

json demo(const TemporaryFolder& folder, const std::string& name,
          std::vector<std::string> arguments) {
  const std::string out = folder / name;
  arguments.insert(arguments.begin(), "demo");
  arguments.insert(arguments.end(), {"--out", out});
  const Finished finished = run(kaz(arguments), std::chrono::seconds(200));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return json::parse(read_file(out + "/result.json"), nullptr, false);
}

TEST(Demo, FindsAndTracksThroughTheEmulatedFirmware) {
  const TemporaryFolder folder;
  const json result = demo(folder, "out", {"--seed", "1"});
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["outcome"], "done");
  EXPECT_EQ(result["mcu"], "h8");
  EXPECT_EQ(result["seed"], 1);
  EXPECT_GT(result["found_s"].get<double>(), 0);
  EXPECT_GE(result["tracking_within_3deg"].get<double>(), 0.9);
  EXPECT_GT(result["rtf"].get<double>(), 0);
  EXPECT_EQ(result["recording_sha256"].get<std::string>().size(), 64u);
  EXPECT_GT(result["tracking_error"].size(), 100u);
  for (const auto& picture : result["pictures"]) {
    EXPECT_GT(std::filesystem::file_size(folder / ("out/" + picture.get<std::string>())), 1000u);
  }
  EXPECT_GE(result["pictures"].size(), 4u);
}

TEST(Demo, NativeEngineDoesTheSame) {
  const TemporaryFolder folder;
  const json result = demo(folder, "out", {"--seed", "1", "--mcu", "native"});
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["mcu"], "native");
  EXPECT_GE(result["tracking_within_3deg"].get<double>(), 0.9);
}

TEST(Demo, ProfileNamesTheParts) {
  const Finished done =
      run(kaz({"run", "track-ball", "--mcu", "native", "--duration", "3", "--profile", "--json"}),
          std::chrono::seconds(60));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const json profile = json::parse(done.out)["profile"];
  std::map<std::string, double> cpu_s;
  double sum_s = 0;
  for (const auto& part : profile["parts"]) sum_s += cpu_s[part["name"]] = part["cpu_s"];
  for (const char* part : {"chip", "body", "drawing", "vision color", "behaviour and link"})
    EXPECT_GT(cpu_s[part], 0) << part << profile;
  EXPECT_NEAR(sum_s, profile["cpu_s"].get<double>(), 0.01 * sum_s) << profile;
}

TEST(Demo, SameSeedSameRecordingOtherSeedAnother) {
  const TemporaryFolder folder;
  const auto hash = [&](const std::string& name, const std::string& seed) {
    const json result = demo(folder, name, {"--seed", seed, "--duration", "6"});
    return result.is_object() ? result["recording_sha256"].get<std::string>() : "no result";
  };
  const std::string first = hash("first", "5");
  EXPECT_EQ(hash("second", "5"), first);
  EXPECT_NE(hash("third", "6"), first);
}

}  // namespace
}  // namespace kaz::test
