// `kaz replay`: an unchanged run is identical, a changed one tells where it begins to differ.
// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/process.h"

namespace kaz::test {
namespace {

using nlohmann::json;

TEST(Replay, IdenticalUnlessSomethingIsChanged) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", file = out + "/recording.mcap";
  const Finished made =
      run(kaz({"run", "search-ball", "--mcu", "native", "--seed", "4", "--out", out}),
          std::chrono::seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.err;

  const Finished same = run(kaz({"replay", file, "--json"}), std::chrono::seconds(100));
  EXPECT_EQ(same.exit_code, 0) << same.err << same.out;
  const json result = json::parse(same.out, nullptr, false);
  ASSERT_TRUE(result.is_object()) << same.out;
  EXPECT_EQ(result["identical"], true);
  EXPECT_EQ(result["mode"], "simulation");
  EXPECT_GT(result["messages"].get<int>(), 1000);

  const Finished other =
      run(kaz({"replay", file, "--seed", "5", "--json"}), std::chrono::seconds(100));
  EXPECT_EQ(other.exit_code, 1) << other.err;
  const json difference = json::parse(other.out, nullptr, false);
  ASSERT_TRUE(difference.is_object()) << other.out;
  EXPECT_EQ(difference["identical"], false);
  EXPECT_LT(difference["time_s"].get<double>(), 1.0);  // noise is there from the first tick on
  EXPECT_NE(difference["recorded"], difference["now"]);
}

TEST(Replay, SaysWhatIsNoRecording) {
  const TemporaryFolder folder;
  const Finished none = run(kaz({"replay", folder / "none"}), std::chrono::seconds(20));
  EXPECT_EQ(none.exit_code, 2);
  std::ofstream(folder / "text") << "no recording at all";
  const Finished text = run(kaz({"replay", folder / "text"}), std::chrono::seconds(20));
  EXPECT_EQ(text.exit_code, 2);
  EXPECT_NE(text.err.find("no MCAP file"), std::string::npos) << text.err;
}

}  // namespace
}  // namespace kaz::test
