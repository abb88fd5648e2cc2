// Recordings of other programs: which topics are the eyes, their calibration, and pairs of pictures.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision_run/picture_topics.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "shared/base/files.hpp"
#include "shared/base/json_testing.h"
#include "sim/runtime/formats/ros_messages.h"
#include "tools/vision_run/recorded_pictures.h"

namespace kaz::tools {
namespace {

using Bytes = std::vector<std::uint8_t>;

// A recording of ROS 1, as of a driver of stereo cameras.
class OthersRecording {
 public:
  std::uint16_t channel(const std::string& topic, const std::string& schema,
                        const std::string& encoding = "ros1") {
    const auto number = static_cast<std::uint16_t>(recording.topics.size() + 1);
    recording.topics[number] = topic;
    recording.encodings[number] = {encoding, number};
    recording.schemas[number] = {schema, "ros1msg", ""};
    return number;
  }
  void picture(std::uint16_t channel, std::uint64_t time_ns, std::uint32_t nanoseconds) {
    Bytes bytes;
    sim::LittleEndian(bytes)
        .number(std::uint32_t{0})
        .number(std::uint32_t{nanoseconds > 0})
        .number(nanoseconds)
        .text("eye")
        .text("png")
        .text("");
    recording.messages.push_back({channel, time_ns, bytes});
  }
  void camera_info(std::uint16_t channel, bool right) {
    Bytes bytes;
    sim::ros::camera_info(bytes, 0, {64, 48, 60, 60, 31.5, 23.5, 0.1}, right);
    recording.messages.push_back({channel, 0, bytes});
  }
  sim::McapRecording recording;
};

constexpr const char* kImage = "sensor_msgs/CompressedImage";
constexpr const char* kInfo = "sensor_msgs/CameraInfo";

TEST(PictureTopics, TheOnlyPairOfLeftAndRightIsFound) {
  OthersRecording others;
  others.channel("/stereo/left/image_raw/compressed", kImage);
  others.channel("/stereo/right/image_raw/compressed", kImage);
  others.channel("/stereo/left/camera_info", kInfo);
  others.channel("/left_arm", "sensor_msgs/JointState");
  const auto topics = stereo_topics(others.recording, "a.mcap", "");
  ASSERT_TRUE(topics) << topics.error().message;
  EXPECT_EQ(topics->left, "/stereo/left/image_raw/compressed");
  EXPECT_EQ(topics->right, "/stereo/right/image_raw/compressed");
}

TEST(PictureTopics, WithoutOnePairTheErrorListsTopicsAndEncodings) {
  OthersRecording others;
  others.channel("/front/image_raw", "sensor_msgs/msg/Image", "cdr");
  others.channel("/points", "foxglove.PointCloud", "protobuf");
  const auto none = stereo_topics(others.recording, "a.mcap", "");
  ASSERT_FALSE(none);
  for (const char* part :
       {"a.mcap: is an MCAP file of another program", "--topics LEFT,RIGHT",
        "/front/image_raw (sensor_msgs/msg/Image, cdr)", "/points (foxglove.PointCloud, protobuf)"})
    EXPECT_NE(none.error().message.find(part), std::string::npos) << none.error().message;
  for (const char* topic : {"/left/a", "/right/a", "/left/b", "/right/b"})
    others.channel(topic, kImage);
  const auto several = stereo_topics(others.recording, "a.mcap", "");
  ASSERT_FALSE(several);
  EXPECT_NE(several.error().message.find("several pairs"), std::string::npos);
  EXPECT_TRUE(stereo_topics(others.recording, "a.mcap", "/left/b,/front/image_raw"));
  for (const char* wrong : {"/left/b", "/left/b,/points", "/left/b,/none", "/a,/b,/c"})
    EXPECT_FALSE(stereo_topics(others.recording, "a.mcap", wrong)) << wrong;
}

TEST(PictureTopics, TheCalibrationIsBesideThePictures) {
  OthersRecording others;
  others.channel("/left/image_raw/compressed", kImage);
  others.channel("/right/image_raw/compressed", kImage);
  const StereoTopics topics{"/left/image_raw/compressed", "/right/image_raw/compressed"};
  const auto missing = recorded_eyes(others.recording, "a.mcap", topics, "");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("--calibration"), std::string::npos);
  others.camera_info(others.channel("/left/camera_info", kInfo), false);
  others.camera_info(others.channel("/right/camera_info", kInfo), true);
  const auto eyes = recorded_eyes(others.recording, "a.mcap", topics, "");
  ASSERT_TRUE(eyes) << eyes.error().message;
  EXPECT_FALSE(eyes->rectified);
  EXPECT_EQ(eyes->calibration.width, 64);
  EXPECT_EQ(eyes->calibration.rectified.fx, 60);
  EXPECT_NEAR(eyes->calibration.rectified.baseline_m, 0.1, 1e-15);
  const auto rectified = recorded_eyes(others.recording, "a.mcap",
                                       {"/left/image_rect_color", "/right/image_rect_color"}, "");
  ASSERT_TRUE(rectified) << rectified.error().message;
  EXPECT_TRUE(rectified->rectified);
  EXPECT_FALSE(
      recorded_eyes(others.recording, "a.mcap", {"/left/image_rect", "/right/image_raw"}, ""));
}

TEST(PictureTopics, PicturesWithinFiveMillisecondsAreAPair) {
  OthersRecording others;
  const auto left = others.channel("/left/image", kImage);
  const auto right = others.channel("/right/image", kImage);
  others.picture(right, 7, 114'000'000);  // out of order
  others.picture(left, 1, 10'000'000);
  others.picture(right, 2, 15'000'000);
  others.picture(left, 3, 60'000'000);  // its partner is missing
  others.picture(left, 4, 110'000'000);
  others.picture(right, 5, 0);  // no time: that of the message, long before
  others.recording.messages.push_back({left, 6, {1, 2, 3}});
  const auto found = pairs_in(others.recording, {"/left/image", "/right/image"});
  ASSERT_EQ(found.pairs.size(), 2u);
  EXPECT_EQ(found.pairs[0].stamp_ns, 1'010'000'000u);
  EXPECT_EQ(found.pairs[0].left->time_ns, 1u);
  EXPECT_EQ(found.pairs[0].right->time_ns, 2u);
  EXPECT_EQ(found.pairs[1].right->time_ns, 7u);
  EXPECT_EQ(found.unpaired, 2u);
  EXPECT_EQ(found.invalid, 1u);
}

TEST(OthersRecording, TheModulesProcessItsPairs) {
  const std::string folder = make_temporary_folder("kaz-others").value();
  RecordedOptions options;
  options.in = "tools/fuzz/inputs/seeds/recording/ros2_stereo.mcap";
  options.out = folder + "/found";
  options.modules = "color";
  const auto ran = run_on_source(options);
  ASSERT_TRUE(ran) << ran.error().message;
  const auto result = parse_json(read_whole_file(options.out + "/result.json", 100'000).value());
  EXPECT_EQ(result["frames_looked_at"], 2);
  EXPECT_EQ(result["frames"][1]["stamp_ns"], 1'700'000'001'000'001'000);
  options.modules = "floor";
  EXPECT_NE(run_on_source(options).error().message.find("posture"), std::string::npos);
  options.in = folder;
  options.topics = "/a,/b";
  EXPECT_NE(run_on_source(options).error().message.find("--topics"), std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace kaz::tools
