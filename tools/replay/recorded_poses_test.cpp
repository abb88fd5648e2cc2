// Poses of /tf: those that are recorded, and messages that are none.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/recorded_poses.h"

#include <limits>

#include <gtest/gtest.h>

#include "sim/runtime/formats/ros_messages.h"

namespace kaz::tools {
namespace {

using sim::ros::NamedPose;

const std::vector<std::string> kFrames{"trunk", "head"};

Eigen::Isometry3d turned(double x, double rad) {
  return Eigen::Translation3d(x, 2, 3) * Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ());
}

class Poses : public testing::Test {
 protected:
  Poses() { recording_.topics = {{1, "/tf"}, {2, "/contacts"}}; }
  void add(std::uint64_t time_ns, const std::vector<NamedPose>& poses) {
    sim::McapRecording::Message message{1, time_ns, {}};
    sim::ros::transforms(message.data, time_ns, poses);
    recording_.messages.push_back(message);
  }
  std::string refusal() {
    const auto read = recorded_poses(recording_, kFrames, "run.mcap");
    if (read) return "";
    EXPECT_EQ(read.error().fault, Fault::usage);
    EXPECT_EQ(read.error().message.find("run.mcap: "), 0u) << read.error().message;
    return read.error().message;
  }
  sim::McapRecording recording_;
};

TEST_F(Poses, AreInTheOrderOfTheFrames) {
  recording_.messages.push_back({2, 5, {1, 2, 3}});
  add(10, {{"head", turned(1, 0.5)}, {"foot", turned(7, 0)}, {"trunk", turned(4, -3)}});
  add(15, {{"map", turned(9, 0)}});
  add(20, {{"trunk", turned(5, 1)}, {"head", turned(2, 0)}});
  const auto read = recorded_poses(recording_, kFrames, "run.mcap");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].time, Time(10));
  EXPECT_TRUE((*read)[0].frames[0].isApprox(turned(4, -3), 1e-12));
  EXPECT_TRUE((*read)[0].frames[1].isApprox(turned(1, 0.5), 1e-12));
  EXPECT_EQ((*read)[1].time, Time(20));
  EXPECT_TRUE((*read)[1].frames[0].isApprox(turned(5, 1), 1e-12));
}

TEST_F(Poses, ARecordingWithoutThemIsRefused) {
  EXPECT_NE(refusal().find("no poses"), std::string::npos) << refusal();
  add(10, {{"trunk", turned(1, 0)}});
  EXPECT_NE(refusal().find("`head`"), std::string::npos) << refusal();
}

TEST_F(Poses, MessagesThatAreNoneAreRefused) {
  const std::vector<NamedPose> good{{"trunk", turned(1, 0)}, {"head", turned(2, 0)}};
  add(10, good);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), 1e9, -std::numeric_limits<double>::infinity()}) {
    recording_.messages.resize(1);
    add(20, {{"trunk", turned(bad, 0)}, {"head", turned(2, 0)}});
    EXPECT_NE(refusal().find("a pose"), std::string::npos) << bad;
  }
  recording_.messages.resize(1);
  add(10, good);
  EXPECT_NE(refusal().find("later"), std::string::npos);
  for (std::size_t cut = 1; cut < recording_.messages[0].data.size(); ++cut) {
    recording_.messages.resize(1);
    add(20, good);
    recording_.messages[1].data.resize(cut);
    EXPECT_NE(refusal(), "") << cut;
  }
  recording_.messages.resize(1);
  recording_.messages[0].data[0] = 0xff;  // many more transforms than there are
  EXPECT_NE(refusal(), "");
}

}  // namespace
}  // namespace kaz::tools
