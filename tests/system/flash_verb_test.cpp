// `kaz flash` over a real pty against `kaz sim`: an erased board, a running one, a killed program, a power
// cut, a file cut off.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/process.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

std::string image() {
  const auto program = std::filesystem::path(kaz({}).front());
  return program.parent_path().parent_path() / "firmware/kaz.mot";
}

class FlashVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(std::filesystem::exists(image()))
        << image() << " is missing: ./tools/dev setup installs its compiler";
    sim_ = std::make_unique<Process>(
        kaz({"sim", "--world", "empty", "--serial", folder_ / "board", "--erased"}));
    ASSERT_TRUE(sim_->wait_for_output("ready", seconds(30))) << sim_->wait(seconds(0)).err;
  }
  std::vector<std::string> write(std::vector<std::string> more) const {
    std::vector<std::string> all{"flash", "write", image(), "--port", folder_ / "board"};
    all.insert(all.end(), more.begin(), more.end());
    return kaz(all);
  }
  std::string control() const { return "ctl:" + (folder_ / "board.ctl"); }

  TemporaryFolder folder_;
  std::unique_ptr<Process> sim_;
};

TEST_F(FlashVerb, ErasedBoardThenTheLoader) {
  const Finished first = run(write({"--reset", control(), "--json"}), seconds(90));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const json report = json::parse(first.out.substr(0, first.out.find('}') + 1), nullptr, false);
  ASSERT_TRUE(report.is_object()) << first.out;
  EXPECT_TRUE(report["verified"]);
  EXPECT_GT(report["efficiency"].get<double>(), 0);
  EXPECT_NE(first.out.find("runs: firmware"), std::string::npos);
  // The same image through the loader: nothing to do.
  const Finished again = run(write({"--json"}), seconds(60));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(json::parse(again.out.substr(0, again.out.find('}') + 1))["written"], 0);
  // A file that was cut off goes nowhere.
  std::string text = read_file(image());
  write_file(folder_ / "cut.mot", text.substr(0, text.size() / 2));
  const Finished cut =
      run(kaz({"flash", "write", folder_ / "cut.mot", "--port", folder_ / "board"}), seconds(20));
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_NE(cut.err.find("cut off"), std::string::npos) << cut.err;
}

TEST_F(FlashVerb, KilledInTheMiddleAndTakenUpAgain) {
  Process killed(write({"--reset", control()}));
  ASSERT_TRUE(killed.wait_for_output("write", seconds(60)));
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(seconds(5)).exit_code, 128 + SIGKILL);
  const Finished again = run(write({"--reset", control()}), seconds(90));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("efficiency"), std::string::npos);
}

TEST_F(FlashVerb, NobodyAnswersWithoutBootMode) {
  const Finished silent = run(write({}), seconds(30));
  EXPECT_EQ(silent.exit_code, 3);
  for (const char* part : {"blank", "expected:", "came:", "1. ", "next: kaz flash write"})
    EXPECT_NE(silent.err.find(part), std::string::npos) << silent.err;
  EXPECT_EQ(
      run(kaz({"flash", "verify", image(), "--port", folder_ / "board", "--reset", control()}))
          .exit_code,
      2);
}

}  // namespace
}  // namespace kaz::test
