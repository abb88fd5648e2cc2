// Pictures and camera calibrations in messages of other programs.
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 and CDR: sensor_msgs/Image, sensor_msgs/CompressedImage and sensor_msgs/CameraInfo. Also
// foxglove_msgs/CompressedImage.
// JSON and protobuf: foxglove.CompressedImage and foxglove.CameraCalibration.
// Raw pictures have the encoding rgb8, bgr8 or mono8. Compressed pictures are PNG or JPEG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "sim/runtime/formats/mcap_reader.h"
#include "vision/calibration/camera_info.h"
#include "vision/image/frame.h"

namespace kaz::sim {

enum class PictureMessageKind : std::uint8_t {
  other,
  raw,          // sensor_msgs/Image
  compressed,   // sensor_msgs/CompressedImage
  foxglove,     // foxglove.CompressedImage
  camera_info,  // sensor_msgs/CameraInfo or foxglove.CameraCalibration
};

// Returns the kind of a channel's messages, from the name of its schema and its encoding.
PictureMessageKind kind_of_channel(const McapRecording& recording, std::uint16_t channel);
inline bool is_picture(PictureMessageKind kind) {
  return kind != PictureMessageKind::other && kind != PictureMessageKind::camera_info;
}
// Returns "TOPIC (SCHEMA, ENCODING)" for messages to users.
std::string channel_text(const McapRecording& recording, std::uint16_t channel);

struct PictureMessage {
  std::uint64_t stamp_ns = 0;  // time of exposure since 1970; 0: the message has none
  std::string encoding;        // encoding of a raw picture; empty: a compressed picture
  std::uint32_t width = 0, height = 0, step = 0;  // px; bytes of a row. Only for raw pictures
  std::vector<std::uint8_t> data;
};

// Parses a message of a picture. The channel of `message` must be a channel of pictures. Fails (usage) with
// one sentence if the message does not have the fields of its schema.
Result<PictureMessage> parse_picture(const McapRecording& recording,
                                     const McapRecording::Message& message);
// Decodes the pixels. Fails (usage) if the encoding is not supported, or if the data do not fit the size. The
// error begins with `name`.
Result<vision::Image> decode_message_picture(const PictureMessage& message,
                                             const std::string& name);

// Parses a message of a camera's calibration. Fails (usage) if the message does not have the fields of its
// schema, or if the pictures are a part of the sensor, or binned.
Result<vision::CameraInfo> parse_camera_info_message(const McapRecording& recording,
                                                     const McapRecording::Message& message);

}  // namespace kaz::sim
