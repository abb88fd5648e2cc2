// `kaz mcu run --flat --semihost` as scripts see it: status, standard output, one line of error.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

class McuFlat : public ::testing::Test {
 protected:
  // Runs these bytes from 0x400.
  Finished program(const std::string& hex, std::vector<std::string> options = {}) {
    std::string bytes;
    for (std::size_t k = 0; k < hex.size(); k += 2)
      bytes += static_cast<char>(std::stoi(hex.substr(k, 2), nullptr, 16));
    std::ofstream(folder_ / "program.bin", std::ios::binary) << bytes;
    std::vector<std::string> all{"mcu", "run",  "--flat", "--semihost",           "--format",
                                 "raw", "--at", "0x400",  folder_ / "program.bin"};
    all.insert(all.end(), options.begin(), options.end());
    return run(kaz(all));
  }
  TemporaryFolder folder_;
};

// mov.l #1,er0; mov.l #0x402,er1; mov.l #3,er2; jsr @@0xc7:8: three bytes of its first operand.
const std::string kWrite = "7A00000000017A01000004027A02000000035FC7";
// mov.w #0xdead,r1; mov.w #0xbeef,r2; mov.w #0x0700,r0; sleep.
const std::string kExit7 = "7901DEAD7902BEEF790007000180";

TEST_F(McuFlat, StatusAndOutputAreThePrograms) {
  const Finished finished = program(kWrite + kExit7);
  EXPECT_EQ(finished.exit_code, 7);
  EXPECT_EQ(finished.out, std::string("\0\0\0", 3));
  EXPECT_EQ(finished.err, "");
}

TEST_F(McuFlat, CountsGoToStandardError) {
  const Finished finished = program(kWrite + kExit7, {"--count"});
  EXPECT_EQ(finished.exit_code, 7);
  EXPECT_EQ(finished.err, "insns=8\nstates=23\n");
}

TEST_F(McuFlat, WhatIsNotAnEndGivesOneLineAnd125) {
  struct Case {
    std::string hex;
    std::string line;
    std::vector<std::string> options;
  };
  for (const Case& c : {Case{"0001", "PC 0x000400, opcode 0x0001", {}},
                        {"0180", "PC 0x000400, opcode 0x0180", {}},
                        {"5FC8", "0xc8", {}},
                        {"5A000401", "PC 0x000401", {}},
                        {"40FE", "PC 0x000400, opcode 0x40fe", {"--max-insns", "1000"}},
                        {"40FE", "PC 0x000400, opcode 0x40fe", {"--max-states", "1000"}}}) {
    const Finished finished = program(c.hex, c.options);
    EXPECT_EQ(finished.exit_code, 125) << c.hex;
    EXPECT_NE(finished.err.find(c.line), std::string::npos) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_EQ(finished.out, "");
  }
}

TEST_F(McuFlat, AFullDiskIsReported) {
  program(kWrite + kExit7);
  const std::string command = kaz({})[0] + " mcu run --flat --semihost --format raw --at 0x400 " +
                              (folder_ / "program.bin") + " > /dev/full";
  const Finished finished = run({"/bin/sh", "-c", command});
  EXPECT_EQ(finished.exit_code, 125);
  EXPECT_NE(finished.err.find("cannot write standard output"), std::string::npos) << finished.err;
}

// A limit that was asked for is no error.
TEST_F(McuFlat, ALimitEndsTheRunInOneLine) {
  const std::string path = folder_ / "endless.bin";
  std::ofstream(path, std::ios::binary) << "\x40\xfe";
  const Finished finished = run(
      kaz({"mcu", "run", "--flat", "--format", "raw", "--at", "0x400", path, "--max-insns", "10"}));
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_EQ(finished.err.rfind("stopped after 10 instructions (--max-insns): PC 0x000400", 0), 0u)
      << finished.err;
}

TEST_F(McuFlat, UnusableImagesAreWrongUsage) {
  EXPECT_EQ(run(kaz({"mcu", "run", "--flat", "--semihost", "/nonexistent"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"mcu", "run", "--semihost", "/nonexistent"})).exit_code, 2);
}

}  // namespace
}  // namespace kaz::test
