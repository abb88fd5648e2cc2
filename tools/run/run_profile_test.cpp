// The table of a profile adds up.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_profile.h"

#include <gtest/gtest.h>

#include <sstream>

namespace kaz::tools {
namespace {

RunProfile example() {
  return {.run_s = 10,
          .wall_s = 2,
          .cpu_s = 3,
          .cores = 2,
          .parts = {{"drawing", 1.5, 0.1, 300}, {"chip", 0.5, 0, 10000}},
          .threads = {{"drawing", 1.5}, {"behavior and link", 0.5}}};
}

TEST(RunProfile, PartsAndTheRestAreAll) {
  const auto json = profile_json(example());
  double cpu_s = 0, share = 0;
  for (const auto& part : json["parts"]) {
    cpu_s += part["cpu_s"].get<double>();
    share += part["cpu_share"].get<double>();
  }
  EXPECT_DOUBLE_EQ(cpu_s, 3);
  EXPECT_DOUBLE_EQ(share, 1);
  EXPECT_EQ(json["parts"].back()["name"], "other");
  EXPECT_DOUBLE_EQ(json["robot_s_per_wall_s"].get<double>(), 5);
  EXPECT_DOUBLE_EQ(json["cores_used"].get<double>(), 1.5);
  EXPECT_DOUBLE_EQ(json["threads"][0]["share_of_a_core"].get<double>(), 0.75);
}

TEST(RunProfile, TextIsATableOfNarrowLines) {
  std::istringstream lines(profile_text(example()));
  std::string line, all;
  while (std::getline(lines, line)) {
    EXPECT_LT(line.size(), 100u) << line;
    all += line + "\n";
  }
  EXPECT_NE(all.find("drawing                      1.500  50.0 %      150.00      0.100\n"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("10.0 s of robot time in 2.00 s: 5.0 times real time"), std::string::npos)
      << all;
  EXPECT_NE(all.find("1.50 of 2 cores used"), std::string::npos) << all;
}

TEST(RunProfile, MeasuresWhatRunsMeanwhile) {
  const RunProfiler profiler;
  {
    const ProfileScope scope("chip");
    volatile double x = 1;
    for (int i = 0; i < 1000000; ++i) x = x * 0.5 + 1;
  }
  const RunProfile profile = profiler.end(1);
  ASSERT_EQ(profile.parts.size(), 1u);
  EXPECT_GT(profile.parts[0].cpu_s, 0);
  EXPECT_GE(profile.cpu_s, profile.parts[0].cpu_s);
}

}  // namespace
}  // namespace kaz::tools
