// The benchmark program as a user runs it. No time is asserted.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

namespace {

namespace fs = std::filesystem;

class Bench : public testing::Test {
 protected:
  Bench() : json_(fs::temp_directory_path() / ("kaz-bench-" + std::to_string(::getpid()))) {}
  ~Bench() override { fs::remove(json_); }
  static int run(const std::string& arguments) {
    const int status = std::system((KAZ_BENCHMARK " " + arguments + " >/dev/null 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json numbers() const {
    std::ifstream file(json_);
    return nlohmann::json::parse(file);
  }
  fs::path json_;
};

TEST_F(Bench, TickIsMeasuredAndWritten) {
  ASSERT_EQ(run("--quick --filter mcu.tick --json " + json_.string()), 0);
  const auto all = numbers();
  ASSERT_EQ(all.size(), 2u) << all;
  // Shares of the tick in per cent; what they must not exceed is the firmware's own test.
  EXPECT_GT(all.at("mcu.tick_median").get<double>(), 10);
  EXPECT_LT(all.at("mcu.tick_worst").get<double>(), 100);
  EXPECT_LE(all.at("mcu.tick_median").get<double>(), all.at("mcu.tick_worst").get<double>());
}

TEST_F(Bench, EmulatorAndFirmwareAreMeasured) {
  ASSERT_EQ(run("--quick --filter 'mips|firmware_x' --json " + json_.string()), 0);
  const auto all = numbers();
  for (const char* name :
       {"mcu.mips.crc", "mcu.mips.matrix", "mcu.mips.mix", "mcu.mips.firmware", "mcu.firmware_x"})
    EXPECT_GT(all.value(name, 0.0), 0) << name;
  EXPECT_FALSE(all.contains("mcu.tick_median"));
}

// The time of all threads, under a name of Google Benchmark's own.
TEST_F(Bench, AllModulesOnAPairAreMeasured) {
  ASSERT_EQ(run("--quick --filter vision.pipeline --json " + json_.string()), 0);
  for (const char* name : {"vision.pipeline_ms.320", "vision.pipeline_ms.640"})
    EXPECT_GT(numbers().value(name, 0.0), 0) << name;
}

// Simulated time: what is due has to be reached here.
TEST_F(Bench, FlashingIsMeasured) {
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(run("--filter flash --json " + json_.string()), 0);
    static nlohmann::json first;
    if (k == 0) first = numbers();
    EXPECT_EQ(numbers(), first);
    EXPECT_GE(numbers().value("flash.efficiency", 0.0), 85);
    EXPECT_LT(numbers().value("flash.efficiency", 0.0), 100);
  }
}

TEST_F(Bench, OtherEnginesHaveTheirNameAtTheEnd) {
  ASSERT_EQ(run("--quick --filter mips.crc --engine reference --json " + json_.string()), 0);
  const auto all = numbers();
  EXPECT_GT(all.value("mcu.mips.crc.reference", 0.0), 0);
  EXPECT_FALSE(all.contains("mcu.mips.crc"));
}

TEST_F(Bench, LoadsRunByThemselves) {
  EXPECT_EQ(run("--run mcu.mips.mix --amount 10"), 0);
  EXPECT_EQ(run("--run mcu.firmware_x --amount 10"), 0);
}

TEST_F(Bench, WrongUsageIsStatus2) {
  EXPECT_EQ(run("--filter no.such.name"), 2);
  EXPECT_EQ(run("--filter '('"), 2);
  EXPECT_EQ(run("--engine none"), 2);
  EXPECT_EQ(run("--run nothing"), 2);
  EXPECT_EQ(run("--help"), 0);
  EXPECT_EQ(run("--list"), 0);
}

TEST_F(Bench, NothingIsLeftWhereTheResultsCannotBeWritten) {
  EXPECT_EQ(run("--quick --filter mcu.tick --json " + json_.string() + "/none/x.json"), 3);
  EXPECT_FALSE(fs::exists(json_));
}

}  // namespace
