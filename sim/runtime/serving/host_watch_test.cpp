// What is said about the host, and when.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/host_watch.h"

#include <gtest/gtest.h>

#include <vector>

namespace kaz::sim {
namespace {

using std::chrono::milliseconds;

struct Heard {
  std::vector<std::string> lines;
  HostWatch watch{"board", [this](const std::string& line) { lines.push_back(line); }};
};

TEST(HostWatch, ReportsComingGoingAndMotors) {
  Heard heard;
  heard.watch.presence(milliseconds(10), true, 115200);
  heard.watch.presence(milliseconds(11), true, 115200);
  heard.watch.bytes_came(milliseconds(100));
  heard.watch.drivers(milliseconds(110), true);
  heard.watch.presence(milliseconds(150), false, 115200);
  heard.watch.drivers(milliseconds(300), false);
  EXPECT_EQ(heard.lines,
            (std::vector<std::string>{"host opened board", "motors on",
                                      "host closed board, 50 ms after its last byte",
                                      "motors off, 200 ms after the host's last byte"}));
}

TEST(HostWatch, ReportsWhyTheMotorsAreOff) {
  Heard heard;
  heard.watch.drivers(milliseconds(10), true, "not said");
  heard.watch.drivers(milliseconds(1234), false, "shutdown, motor stalled (l_knee)");
  heard.watch.drivers(milliseconds(1300), false, "not said");
  EXPECT_EQ(heard.lines,
            (std::vector<std::string>{"motors on",
                                      "motors off at 1.234 s: shutdown, motor stalled (l_knee)"}));
}

TEST(HostWatch, ReportsHeldJointsOnceForEachSilence) {
  Heard heard;
  EXPECT_FALSE(heard.watch.may_hold(milliseconds(50)));  // no host yet
  heard.watch.bytes_came(milliseconds(100));
  EXPECT_FALSE(heard.watch.may_hold(milliseconds(109)));
  EXPECT_TRUE(heard.watch.may_hold(milliseconds(110)));
  heard.watch.held(milliseconds(191));
  EXPECT_FALSE(heard.watch.may_hold(milliseconds(300)));
  heard.watch.bytes_came(milliseconds(400));
  EXPECT_TRUE(heard.watch.may_hold(milliseconds(490)));
  EXPECT_EQ(heard.lines, (std::vector<std::string>{"at 0.191 s, 91 ms after the host's last byte, "
                                                   "the link watchdog began to hold the joints"}));
}

TEST(HostWatch, ReportsSilenceOnce) {
  Heard heard;
  heard.watch.presence(milliseconds(0), true, 115200);
  heard.watch.check_silence(milliseconds(5000));  // it never spoke
  heard.watch.bytes_came(milliseconds(5000));
  heard.watch.check_silence(milliseconds(5999));
  EXPECT_EQ(heard.lines.size(), 1u);
  heard.watch.check_silence(milliseconds(6000));
  heard.watch.check_silence(milliseconds(7000));
  heard.watch.bytes_came(milliseconds(7500));
  EXPECT_EQ(heard.lines, (std::vector<std::string>{"host opened board", "host silent for 1000 ms",
                                                   "host sends again"}));
}

TEST(HostWatch, ReportsAWrongSpeed) {
  Heard heard;
  heard.watch.presence(milliseconds(0), true, 115200);
  heard.watch.presence(milliseconds(1), true, 9600);
  heard.watch.presence(milliseconds(2), true, 9600);
  ASSERT_EQ(heard.lines.size(), 2u);
  EXPECT_NE(heard.lines[1].find("9600 baud"), std::string::npos);
  EXPECT_NE(heard.lines[1].find("115200"), std::string::npos);
}

TEST(HostWatch, ReportsLostBytesOnce) {
  Heard heard;
  heard.watch.presence(milliseconds(0), true, 115200);
  heard.watch.bytes_lost(12);
  heard.watch.bytes_lost(12);
  EXPECT_EQ(heard.lines.size(), 2u);
}

}  // namespace
}  // namespace kaz::sim
