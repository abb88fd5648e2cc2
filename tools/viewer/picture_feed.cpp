// Encodes pictures, and limits their rate.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/picture_feed.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "shared/picture/jpeg.h"
#include "sim/runtime/formats/ros_messages.h"

namespace kaz::viewer {
namespace {

using sim::LittleEndian;
using sim::ros::header;

#define KAZ_2D                                                           \
  KAZ_ROS_MSG "foxglove_msgs/Point2\nfloat64 x\nfloat64 y\n" KAZ_ROS_MSG \
              "foxglove_msgs/Color\nfloat64 r\nfloat64 g\nfloat64 b\nfloat64 a\n"
constexpr char kAnnotations[] =
    "foxglove_msgs/CircleAnnotation[] circles\nfoxglove_msgs/PointsAnnotation[] points\n"
    "foxglove_msgs/TextAnnotation[] texts\n" KAZ_ROS_MSG
    "foxglove_msgs/CircleAnnotation\ntime timestamp\nfoxglove_msgs/Point2 position\n"
    "float64 diameter\nfloat64 thickness\nfoxglove_msgs/Color fill_color\n"
    "foxglove_msgs/Color outline_color\n" KAZ_ROS_MSG
    "foxglove_msgs/PointsAnnotation\nuint8 UNKNOWN=0\nuint8 POINTS=1\nuint8 LINE_LOOP=2\n"
    "uint8 LINE_STRIP=3\nuint8 LINE_LIST=4\ntime timestamp\nuint8 type\n"
    "foxglove_msgs/Point2[] points\nfoxglove_msgs/Color outline_color\n"
    "foxglove_msgs/Color[] outline_colors\nfoxglove_msgs/Color fill_color\n"
    "float64 thickness\n" KAZ_ROS_MSG
    "foxglove_msgs/TextAnnotation\ntime timestamp\nfoxglove_msgs/Point2 position\nstring text\n"
    "float64 font_size\nfoxglove_msgs/Color text_color\n"
    "foxglove_msgs/Color background_color\n" KAZ_2D;

constexpr std::uint64_t kSecond = 1'000'000'000;

std::uint64_t time_of(const vision::FrameInfo& info) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, info.exposure.count()));
}

}  // namespace

PictureFeed::PictureFeed(Server& server) : server_(server) {
  const auto add = [&server](const char* topic, const char* name, const char* schema) {
    return server.add_channel({0, topic, "ros1", name, "ros1msg", schema}, true);
  };
  channels_.left = add("/eyes/left", "sensor_msgs/CompressedImage", sim::ros::kPicture);
  channels_.right = add("/eyes/right", "sensor_msgs/CompressedImage", sim::ros::kPicture);
  channels_.annotations =
      add("/eyes/left/annotations", "foxglove_msgs/ImageAnnotations", kAnnotations);
  channels_.left_info =
      add("/eyes/left/camera_info", "sensor_msgs/CameraInfo", sim::ros::kCameraInfo);
  channels_.right_info =
      add("/eyes/right/camera_info", "sensor_msgs/CameraInfo", sim::ros::kCameraInfo);
}

void PictureFeed::camera(std::uint64_t time_ns, const vision::CameraModel& model,
                         std::vector<std::uint8_t>& data) {
  for (const bool right : {false, true}) {
    const auto channel = right ? channels_.right_info : channels_.left_info;
    if (!server_.wanted(channel)) continue;
    data.clear();
    sim::ros::camera_info(data, time_ns, model, right);
    server_.publish(channel, time_ns, data);
  }
}

bool PictureFeed::wants_pictures() const {
  return server_.wanted(channels_.left) || server_.wanted(channels_.right);
}

void PictureFeed::pictures(const vision::StereoPair& pair, bool pixels) {
  const auto time_ns = time_of(pair.info);
  // Earlier than the last by more than that: another run.
  if (time_ns < next_picture_ns_ && time_ns + kSecond > next_picture_ns_) return;
  // Half of the eyes' pictures: coding them takes most of what a viewer costs.
  next_picture_ns_ = time_ns + kSecond / 16;
  std::vector<std::uint8_t> data;
  camera(time_ns, pair.info.camera, data);
  const bool left = server_.wanted(channels_.left), right = server_.wanted(channels_.right);
  if (!pixels || (!left && !right)) return;
  const auto images = pair.images.get();
  if (!images) return;
  if (left) jpeg(channels_.left, pair.info, images->left, "left_eye");
  if (right) jpeg(channels_.right, pair.info, images->right, "right_eye");
}

void PictureFeed::jpeg(std::uint32_t channel, const vision::FrameInfo& info,
                       const vision::Image& image, std::string_view frame) {
  const auto coded =
      picture::encode_jpeg({image.width, image.height, 3, 8, image.rgb}, {80, false});
  if (!coded) return;
  const auto time_ns = time_of(info);
  std::vector<std::uint8_t> data;
  LittleEndian to(data);
  header(to, time_ns, frame, static_cast<std::uint32_t>(info.sequence))
      .text("jpeg")
      .number(static_cast<std::uint32_t>(coded->size()))
      .bytes(*coded);
  server_.publish(channel, time_ns, data);
}

std::uint32_t PictureFeed::add_pictures(const std::string& topic) {
  return server_.add_channel(
      {0, topic, "ros1", "sensor_msgs/CompressedImage", "ros1msg", sim::ros::kPicture}, true);
}

bool PictureFeed::wants_picture(std::uint32_t channel, const vision::FrameInfo& info) {
  if (!server_.wanted(channel)) return false;
  const auto time_ns = time_of(info);
  std::uint64_t& next = next_made_ns_[channel];
  if (time_ns < next && time_ns + kSecond > next) return false;
  next = time_ns + kSecond / 8;
  return true;
}

void PictureFeed::picture(std::uint32_t channel, const vision::FrameInfo& info,
                          const vision::Image& image) {
  jpeg(channel, info, image, "left_eye");
}

void PictureFeed::ball(const vision::FrameInfo& info, const vision::BallObservation& ball) {
  if (!server_.wanted(channels_.annotations)) return;
  const auto time_ns = time_of(info);
  std::vector<std::uint8_t> data;
  LittleEndian to(data);
  const auto stamp = [&] {
    to.number(static_cast<std::uint32_t>(time_ns / kSecond))
        .number(static_cast<std::uint32_t>(time_ns % kSecond));
  };
  constexpr std::array kYellow{0.94, 0.89, 0.26, 1.0}, kNone{0.0, 0.0, 0.0, 0.0};
  to.number(std::uint32_t{ball.found ? 1u : 0u});
  if (ball.found) {
    stamp();
    to.real(ball.center_u).real(ball.center_v).real(2 * ball.radius_px).real(2);
    to.reals(kNone).reals(kYellow);
  }
  to.number(std::uint32_t{0});
  to.number(std::uint32_t{ball.found ? 1u : 0u});
  if (ball.found) {
    char text[48];
    std::snprintf(text, sizeof text, "%.2f m", ball.distance_m);
    stamp();
    to.real(ball.center_u + ball.radius_px + 3).real(ball.center_v).text(text).real(12);
    to.reals(kYellow).reals(kNone);
  }
  server_.publish(channels_.annotations, time_ns, data);
}

}  // namespace kaz::viewer
