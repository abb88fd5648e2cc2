// Diagnostics of a slow port and of missing permissions, and the udev rule that fixes both.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/measure_link.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

namespace kaz::host {
namespace {

constexpr Time kByte = std::chrono::nanoseconds(86805);

TEST(MeasureLink, IsContentWithAQuickPort) {
  const auto check = judge_round_trip("/dev/kaz", 4.1e-3, kByte, LowLatency::set);
  EXPECT_FALSE(check.slow);
  EXPECT_NEAR(check.expected_s, 26 * 86.805e-6 + 2.2e-3, 1e-9);
  EXPECT_EQ(check.sentence, "round trip on /dev/kaz: 4.1 ms (wire and board: up to 4.5 ms)");
}

TEST(MeasureLink, SaysWhatToDoAboutASlowOne) {
  EXPECT_FALSE(judge_round_trip("/dev/kaz", 6.3e-3, kByte, LowLatency::refused).slow);
  const auto check = judge_round_trip("/dev/kaz", 19e-3, kByte, LowLatency::refused);
  EXPECT_TRUE(check.slow);
  EXPECT_NE(check.sentence.find("70-kaz.rules"), std::string::npos);
  EXPECT_NE(judge_round_trip("p", 19e-3, kByte, LowLatency::set).sentence.find("hub"),
            std::string::npos);
  EXPECT_NE(
      judge_round_trip("p", 19e-3, kByte, LowLatency::pseudo_terminal).sentence.find("simulator"),
      std::string::npos);
}

TEST(MeasureLink, PermissionSentenceHoldsTheRule) {
  EXPECT_EQ(permission_sentence("/dev/ttyS0", "", "", "dialout"),
            "permission denied for /dev/ttyS0: add yourself to its group (`sudo adduser $USER "
            "dialout`) and log in again");
  EXPECT_NE(permission_sentence("/dev/ttyUSB0", "0403", "6001", "")
                .find("SUBSYSTEM==\"tty\", ATTRS{idVendor}==\"0403\", ATTRS{idProduct}==\"6001\", "
                      "GROUP=\"dialout\""),
            std::string::npos);
}

// Each line is keys, operators and quoted values, as udev(7) has them; labels exist.
TEST(UdevRule, IsWellFormedAndDoesWhatItSays) {
  std::ifstream file("tools/udev/70-kaz.rules");
  ASSERT_TRUE(file);
  const std::string keys =
      R"re((ACTION|SUBSYSTEMS?|DRIVERS|ATTRS?\{\w+\}|ENV\{\w+\}|GROUP|MODE|SYMLINK|GOTO|LABEL))re";
  const std::string token = keys + R"re((==|!=|=|\+=)"[^"]+")re";
  const std::regex rule(token + "(, " + token + ")*");
  std::string all;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    all += line + "\n";
    EXPECT_TRUE(std::regex_match(line, rule)) << line;
  }
  for (const char* must : {"ATTR{latency_timer}=\"1\"", "GROUP=\"dialout\"", "SYMLINK+=\"kaz\"",
                           "LABEL=\"kaz_latency\"", "GOTO=\"kaz_latency\""}) {
    EXPECT_NE(all.find(must), std::string::npos) << must;
  }
}

}  // namespace
}  // namespace kaz::host
