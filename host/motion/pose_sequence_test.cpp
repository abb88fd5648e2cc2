// Files of poses, and the motion through them.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/pose_sequence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace kaz::motion {
namespace {

const std::array<std::string, 3> kJoints{"pan", "tilt", "knee"};

std::string file(const std::string& poses) {
  return R"({"format": "kaz-poses-1", "poses": [)" + poses + "]}";
}

PoseMotion motion_of(const std::string& poses) {
  const auto sequence = parse_poses(file(poses), "file");
  EXPECT_TRUE(sequence) << sequence.error().message;
  auto motion = PoseMotion::create(sequence.value(), kJoints);
  EXPECT_TRUE(motion) << motion.error().message;
  return motion.value();
}

TEST(Poses, AreReadAndWritten) {
  const std::string text = file(R"({"time_s": 0, "angles_rad": {"pan": 0.5}},)"
                                R"({"time_s": 1.5, "angles_rad": {"tilt": -0.25, "pan": 0}})");
  const auto read = parse_poses(text, "file");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->poses.size(), 2u);
  EXPECT_DOUBLE_EQ(read->poses[1].time_s, 1.5);
  EXPECT_EQ(read->poses[1].angles_rad,
            (std::vector<std::pair<std::string, double>>{{"tilt", -0.25}, {"pan", 0}}));
  const std::string written = text_of(*read);
  const auto again = parse_poses(written, "file");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(text_of(*again), written);
  EXPECT_EQ(written.find('\n'), std::string::npos);
}

TEST(Poses, WhatIsWrongIsNamed) {
  const std::string one = R"({"time_s": 1, "angles_rad": {"pan": 0}})";
  for (const auto& [text, hint] : std::vector<std::pair<std::string, std::string>>{
           {"", "line 1 is not valid JSON"},
           {file(R"({"time_s": 0, "angles_rad": {"pan": 1e999}})"),
            "line 1: the number 1e999 is too large: the limit is 1.8e308"},
           {file(R"({"time_s": 0, "angles_rad": {"pan": 0, "pan": 0.5}})"),
            "the key \"pan\" occurs twice in one object; remove one"},
           {"{\"format\": \"kaz-poses-1\",\n \"poses\": [,]}", "line 2"},
           {"[]", "not a JSON object"},
           {R"({"poses": []})", "\"format\" must be"},
           {file(""), "a list of 1 to 1000"},
           {file("3"), "pose 1 is not an object"},
           {file(R"({"angles_rad": {}})"), "pose 1 has no number \"time_s\""},
           {file(R"({"time_s": -1, "angles_rad": {}})"), "\"time_s\" must be 0 to 600"},
           {file(R"({"time_s": 0})"), "pose 1 has no object \"angles_rad\""},
           {file(R"({"time_s": 0, "angles_rad": {}})"), "no pose names a joint"},
           {file(R"({"time_s": 0, "angles_rad": {"pan": "up"}})"), "of \"pan\" is not a number"},
           {file(R"({"time_s": 0, "angles_rad": {"pan": 45}})"),
            "\"pan\" is 45: must be -pi to pi rad"},
           {file(R"({"time_s": 0, "angles": {}})"), "unknown key \"angles\""},
           {file(one + "," + one), "pose 2 is not later"}}) {
    const auto read = parse_poses(text, "some.json");
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().fault, Fault::usage);
    EXPECT_NE(read.error().message.find(hint), std::string::npos) << read.error().message;
    EXPECT_TRUE(read.error().message.starts_with("some.json: "));
  }
  const auto read = parse_poses(file(R"({"time_s": 0, "angles_rad": {"wing": 1}})"), "file");
  const auto motion = PoseMotion::create(read.value(), kJoints);
  ASSERT_FALSE(motion);
  EXPECT_NE(motion.error().message.find("\"wing\", which this robot does not have; it has pan"),
            std::string::npos);
}

TEST(PoseMotion, PassesThroughEachPoseAtItsTime) {
  const PoseMotion motion = motion_of(R"({"time_s": 0.5, "angles_rad": {"pan": 0.1}},)"
                                      R"({"time_s": 1, "angles_rad": {"pan": 0.4, "knee": 1}},)"
                                      R"({"time_s": 3, "angles_rad": {"knee": -1}},)"
                                      R"({"time_s": 4, "angles_rad": {"pan": -0.2}})");
  EXPECT_DOUBLE_EQ(motion.end_s(), 4);
  for (const auto& [time, pan, knee] : std::initializer_list<std::array<double, 3>>{
           {0, 0.1, 1}, {0.5, 0.1, 1}, {1, 0.4, 1}, {3, NAN, -1}, {4, -0.2, -1}, {9, -0.2, -1}}) {
    const auto targets = motion.at(time);
    ASSERT_EQ(targets.size(), 2u);  // none for `tilt`
    EXPECT_EQ(targets[0].joint, 0);
    if (!std::isnan(pan)) {
      EXPECT_NEAR(targets[0].angle_rad, pan, 1e-12) << time;
    }
    EXPECT_EQ(targets[1].joint, 2);
    EXPECT_NEAR(targets[1].angle_rad, knee, 1e-12) << time;
  }
}

// No overshoot, no step in angle or speed, at rest at both ends; and extents() says what differences of at()
// say.
TEST(PoseMotion, IsMonotoneBetweenPosesAndSmooth) {
  const PoseMotion motion = motion_of(
      R"({"time_s": 0, "angles_rad": {"pan": 0}}, {"time_s": 0.2, "angles_rad": {"pan": 1}},)"
      R"({"time_s": 1, "angles_rad": {"pan": 1.1}}, {"time_s": 2, "angles_rad": {"pan": 1.1}},)"
      R"({"time_s": 2.3, "angles_rad": {"pan": -1}}, {"time_s": 3, "angles_rad": {"pan": -0.9}})");
  constexpr double kStep = 1e-4, kTimes[] = {0, 0.2, 1, 2, 2.3, 3},
                   kAngles[] = {0, 1, 1.1, 1.1, -1, -0.9};
  double before = motion.at(0)[0].angle_rad, speed_before = 0, fastest = 0;
  for (int i = 1; i * kStep <= 3; ++i) {
    const double time = i * kStep, angle = motion.at(time)[0].angle_rad;
    std::size_t piece = 0;
    while (piece < 4 && time > kTimes[piece + 1]) ++piece;
    EXPECT_GE(angle, std::min(kAngles[piece], kAngles[piece + 1]) - 1e-9) << time;
    EXPECT_LE(angle, std::max(kAngles[piece], kAngles[piece + 1]) + 1e-9) << time;
    const double speed = (angle - before) / kStep;
    // The steepest piece has 6 * 2.1 rad / (0.3 s)^2 = 140 rad/s^2 at its ends, the first 150.
    EXPECT_LT(std::abs(speed - speed_before), 200 * kStep) << time;
    fastest = std::max(fastest, std::abs(speed));
    before = angle;
    speed_before = speed;
  }
  EXPECT_LT(std::abs(speed_before), 200 * kStep);
  const auto extents = motion.extents();
  ASSERT_EQ(extents.size(), 1u);
  EXPECT_NEAR(extents[0].fastest_rad_per_s, fastest, 1e-3 * fastest);
  EXPECT_NEAR(extents[0].fastest_at_s, 2.15, 0.05);
  EXPECT_DOUBLE_EQ(extents[0].lowest_rad, -1);
  EXPECT_DOUBLE_EQ(extents[0].highest_rad, 1.1);
}

}  // namespace
}  // namespace kaz::motion
