// Decodes pictures and camera calibrations of ROS and Foxglove.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_messages.h"

#include <array>
#include <optional>
#include <string_view>

#include "shared/base/bounded_json.hpp"
#include "shared/base/one_line.hpp"
#include "shared/picture/picture.h"
#include "sim/runtime/formats/message_fields.h"
#include "sim/runtime/formats/protobuf_fields.h"
#include "vision/image/picture_file.h"

namespace kaz::sim {
namespace {

using Json = nlohmann::json;
using Kind = PictureMessageKind;
using Message = McapRecording::Message;

constexpr std::size_t kMaxCoefficients = 14;

struct PictureSchema {
  std::string_view name;
  Kind kind;
};
constexpr PictureSchema kRosSchemas[] = {{"sensor_msgs/Image", Kind::raw},
                                         {"sensor_msgs/CompressedImage", Kind::compressed},
                                         {"foxglove_msgs/CompressedImage", Kind::foxglove},
                                         {"sensor_msgs/CameraInfo", Kind::camera_info}};
// In JSON and protobuf.
constexpr PictureSchema kFoxgloveSchemas[] = {{"foxglove.CompressedImage", Kind::foxglove},
                                              {"foxglove.CameraCalibration", Kind::camera_info}};

struct ChannelForm {
  std::string schema, encoding;
};

ChannelForm form_of(const McapRecording& recording, std::uint16_t channel) {
  const auto found = recording.encodings.find(channel);
  if (found == recording.encodings.end()) return {};
  const auto schema = recording.schemas.find(found->second.schema);
  return {schema == recording.schemas.end() ? "" : schema->second.name, found->second.message};
}

tl::unexpected<Error> wrong_fields(const std::string& schema) {
  return fail(Fault::usage, "the message does not have the fields of " + shown_text(schema));
}

std::uint64_t stamp_of(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return std::uint64_t{seconds} * 1'000'000'000 + nanoseconds;
}

// time and frame_id, in ROS 1 after a sequence number if the message has a std_msgs/Header.
std::uint64_t take_stamp(MessageFields& fields, MessageFields::Wire wire, bool header) {
  if (header && wire == MessageFields::Wire::ros1) fields.number<std::uint32_t>();
  const auto seconds = fields.number<std::uint32_t>();
  const auto nanoseconds = fields.number<std::uint32_t>();
  fields.text();
  return stamp_of(seconds, nanoseconds);
}

std::optional<std::vector<std::uint8_t>> decode_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> values;
  values.fill(-1);
  for (std::size_t k = 0; k < kDigits.size(); ++k)
    values[static_cast<unsigned char>(kDigits[k])] = static_cast<int>(k);
  while (text.ends_with('=')) text.remove_suffix(1);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

// Returns a member that has the type of `other`. Returns `other` if no member has this type.
template <class T>
T member(const Json& object, const char* name, T other) {
  const auto found = object.find(name);
  if (found == object.end()) return other;
  if constexpr (std::is_same_v<T, std::string>) {
    return found->is_string() ? found->template get<T>() : other;
  } else if constexpr (std::is_same_v<T, Json>) {
    return *found;
  } else {
    return found->is_number_unsigned() && *found <= 0xFFFFFFFFu ? found->template get<T>() : other;
  }
}

Result<Json> parse_message_json(const Message& message, const std::string& schema) {
  const std::string_view text(reinterpret_cast<const char*>(message.data.data()),
                              message.data.size());
  const auto json = parse_bounded_json(text);
  if (!json || !json->is_object()) return wrong_fields(schema);
  return *json;
}

Result<PictureMessage> parse_json_picture(const Message& message, const std::string& schema) {
  const Json json = KAZ_TRY(parse_message_json(message, schema));
  const Json stamp = member(json, "timestamp", Json::object());
  PictureMessage picture;
  if (stamp.is_object())
    picture.stamp_ns = stamp_of(member(stamp, "sec", 0u), member(stamp, "nsec", 0u));
  auto data = decode_base64(member(json, "data", std::string()));
  if (!data) return wrong_fields(schema);
  picture.data = std::move(*data);
  return picture;
}

// Copies pixels of a raw picture, whose size is checked.
vision::Image raw_pixels(const PictureMessage& message, std::size_t channels) {
  vision::Image image{static_cast<int>(message.width), static_cast<int>(message.height), {}};
  image.rgb.reserve(std::size_t{3} * message.width * message.height);
  const bool bgr = message.encoding == "bgr8";
  for (std::size_t v = 0; v < message.height; ++v) {
    const std::uint8_t* pixel = message.data.data() + v * message.step;
    for (std::size_t u = 0; u < message.width; ++u, pixel += channels) {
      for (const std::size_t c : {std::size_t{0}, std::size_t{1}, std::size_t{2}})
        image.rgb.push_back(channels == 1 ? *pixel : pixel[bgr ? 2 - c : c]);
    }
  }
  return image;
}

std::vector<double> numbers_in(const Json& json, const char* name) {
  std::vector<double> numbers;
  const Json list = member(json, name, Json::array());
  if (!list.is_array() || list.size() > kMaxCoefficients) return numbers;
  for (const Json& one : list) numbers.push_back(one.is_number() ? one.get<double>() : 0);
  return numbers;
}

Result<vision::CameraInfo> parse_json_camera_info(const Message& message,
                                                  const std::string& schema) {
  const Json json = KAZ_TRY(parse_message_json(message, schema));
  return vision::CameraInfo{.width = member(json, "width", 0u),
                            .height = member(json, "height", 0u),
                            .model = member(json, "distortion_model", std::string()),
                            .d = numbers_in(json, "D"),
                            .k = numbers_in(json, "K"),
                            .r = numbers_in(json, "R"),
                            .p = numbers_in(json, "P")};
}

// google.protobuf.Timestamp: seconds and nanoseconds.
std::uint64_t take_protobuf_stamp(ProtobufFields::Bytes bytes) {
  std::uint32_t seconds = 0, nanoseconds = 0;
  ProtobufFields fields(bytes);
  while (const auto field = fields.next()) {
    if (field->number == 1) seconds = static_cast<std::uint32_t>(field->value);
    if (field->number == 2) nanoseconds = static_cast<std::uint32_t>(field->value);
  }
  return stamp_of(seconds, nanoseconds);
}

Result<PictureMessage> parse_protobuf_picture(const Message& message, const std::string& schema) {
  PictureMessage picture;
  ProtobufFields fields(message.data);
  while (const auto field = fields.next()) {
    if (field->number == 1) picture.stamp_ns = take_protobuf_stamp(field->bytes);
    if (field->number == 2) picture.data.assign(field->bytes.begin(), field->bytes.end());
  }
  if (!fields.good()) return wrong_fields(schema);
  return picture;
}

Result<vision::CameraInfo> parse_protobuf_camera_info(const Message& message,
                                                      const std::string& schema) {
  vision::CameraInfo info;
  std::array<std::vector<double>*, 4> lists = {&info.d, &info.k, &info.r, &info.p};
  ProtobufFields fields(message.data);
  while (const auto field = fields.next()) {
    if (field->number == 2) info.width = static_cast<std::uint32_t>(field->value);
    if (field->number == 3) info.height = static_cast<std::uint32_t>(field->value);
    if (field->number == 4) info.model.assign(field->bytes.begin(), field->bytes.end());
    if (field->number < 5 || field->number > 8) continue;
    std::vector<double>& list = *lists[field->number - 5];
    add_protobuf_doubles(*field, list);
    if (list.size() > kMaxCoefficients) return wrong_fields(schema);
  }
  if (!fields.good()) return wrong_fields(schema);
  return info;
}

MessageFields::Wire wire_of(const ChannelForm& form) {
  return form.encoding == "ros1" ? MessageFields::Wire::ros1 : MessageFields::Wire::cdr;
}

}  // namespace

Kind kind_of_channel(const McapRecording& recording, std::uint16_t channel) {
  auto [schema, encoding] = form_of(recording, channel);
  if (encoding == "json" || encoding == "protobuf") {
    for (const PictureSchema& one : kFoxgloveSchemas)
      if (schema == one.name) return one.kind;
    return Kind::other;
  }
  if (encoding != "ros1" && encoding != "cdr") return Kind::other;
  // ROS 2 names a type "sensor_msgs/msg/Image".
  if (const auto at = schema.find("/msg/"); at != std::string::npos) schema.erase(at, 4);
  for (const PictureSchema& one : kRosSchemas)
    if (schema == one.name) return one.kind;
  return Kind::other;
}

std::string channel_text(const McapRecording& recording, std::uint16_t channel) {
  const auto [schema, encoding] = form_of(recording, channel);
  const auto topic = recording.topics.find(channel);
  return shown_text(topic == recording.topics.end() ? "?" : topic->second) + " (" +
         (schema.empty() ? "no schema" : shown_text(schema)) + ", " + shown_text(encoding) + ")";
}

Result<PictureMessage> parse_picture(const McapRecording& recording, const Message& message) {
  const ChannelForm form = form_of(recording, message.channel);
  if (form.encoding == "json") return parse_json_picture(message, form.schema);
  if (form.encoding == "protobuf") return parse_protobuf_picture(message, form.schema);
  const Kind kind = kind_of_channel(recording, message.channel);
  MessageFields fields(wire_of(form), message.data);
  PictureMessage picture;
  picture.stamp_ns = take_stamp(fields, wire_of(form), kind != Kind::foxglove);
  if (kind == Kind::raw) {
    picture.height = fields.number<std::uint32_t>();
    picture.width = fields.number<std::uint32_t>();
    picture.encoding = fields.text();
    fields.number<std::uint8_t>();  // byte order, for numbers of 16 bits
    picture.step = fields.number<std::uint32_t>();
  } else if (kind == Kind::compressed) {
    fields.text();  // the format, which the data state, too
  }
  const auto data = fields.array();
  if (!fields.good()) return wrong_fields(form.schema);
  picture.data.assign(data.begin(), data.end());
  return picture;
}

Result<vision::Image> decode_message_picture(const PictureMessage& message,
                                             const std::string& name) {
  if (message.encoding.empty() && message.width == 0)
    return vision::decode_picture(message.data, name);
  const bool gray = message.encoding == "mono8";
  if (!gray && message.encoding != "rgb8" && message.encoding != "bgr8")
    return fail(Fault::usage, name + ": the encoding " + shown_text(message.encoding) +
                                  " is not supported: must be rgb8, bgr8 or mono8");
  const std::size_t channels = gray ? 1 : 3;
  if (!picture::within({}, message.width, message.height) ||
      message.step < channels * message.width ||
      message.data.size() < std::size_t{message.step} * message.height)
    return fail(Fault::usage, name + ": " + std::to_string(message.data.size()) +
                                  " bytes are not a picture of " + std::to_string(message.width) +
                                  " x " + std::to_string(message.height) + " px with " +
                                  std::to_string(message.step) + " bytes per row");
  return raw_pixels(message, channels);
}

Result<vision::CameraInfo> parse_camera_info_message(const McapRecording& recording,
                                                     const Message& message) {
  const ChannelForm form = form_of(recording, message.channel);
  if (form.encoding == "json") return parse_json_camera_info(message, form.schema);
  if (form.encoding == "protobuf") return parse_protobuf_camera_info(message, form.schema);
  MessageFields fields(wire_of(form), message.data);
  take_stamp(fields, wire_of(form), true);
  vision::CameraInfo info;
  info.height = fields.number<std::uint32_t>();
  info.width = fields.number<std::uint32_t>();
  info.model = fields.text();
  const auto count = fields.number<std::uint32_t>();
  if (count > kMaxCoefficients) return wrong_fields(form.schema);
  info.d = fields.reals(count);
  info.k = fields.reals(9);
  info.r = fields.reals(9);
  info.p = fields.reals(12);
  const auto binning_x = fields.number<std::uint32_t>(), binning_y = fields.number<std::uint32_t>();
  std::array<std::uint32_t, 4> roi{};  // x, y, height, width; all 0: the whole sensor
  for (std::uint32_t& one : roi) one = fields.number<std::uint32_t>();
  if (!fields.good()) return wrong_fields(form.schema);
  const bool part = roi[0] > 0 || roi[1] > 0 || (roi[2] > 0 && roi[2] != info.height) ||
                    (roi[3] > 0 && roi[3] != info.width);
  if (binning_x > 1 || binning_y > 1 || part)
    return fail(Fault::usage,
                "the pictures are binned, or show a part of the sensor (roi): give --calibration "
                "for these pictures");
  return info;
}

}  // namespace kaz::sim
