// Pictures and calibrations of ROS 1, ROS 2 (CDR) and Foxglove (JSON).
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_messages.h"

#include <gtest/gtest.h>

#include "shared/picture/png.h"
#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/formats/message_fields.h"

namespace kaz::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Kind = PictureMessageKind;

// A recording with one channel of this schema.
McapRecording with_channel(const std::string& schema, const std::string& encoding) {
  McapRecording recording;
  recording.topics[1] = "/left/image_raw";
  recording.encodings[1] = {encoding, 7};
  recording.schemas[7] = {schema, "ros2msg", ""};
  return recording;
}

// Writes CDR with the alignment of XCDR 1.
class CdrWriter {
 public:
  template <std::unsigned_integral T>
  CdrWriter& number(T value) {
    while (bytes_.size() % sizeof(T) != 0) bytes_.push_back(0xEE);
    LittleEndian(bytes_).number(value);
    return *this;
  }
  CdrWriter& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
    return *this;
  }
  CdrWriter& array(const Bytes& values) {
    number(static_cast<std::uint32_t>(values.size()));
    bytes_.insert(bytes_.end(), values.begin(), values.end());
    return *this;
  }
  CdrWriter& reals(const std::vector<double>& values) {
    for (const double value : values) number(std::bit_cast<std::uint64_t>(value));
    return *this;
  }
  Bytes message() const {
    Bytes all{0, 1, 0, 0};
    all.insert(all.end(), bytes_.begin(), bytes_.end());
    return all;
  }

 private:
  Bytes bytes_;
};

// 2 x 2 pixels with a padding byte after each row.
const Bytes kRows = {1, 2, 3, 4, 5, 6, 99, 7, 8, 9, 10, 11, 12, 99};

Bytes ros1_picture(const std::string& encoding, std::uint32_t step, const Bytes& data) {
  Bytes bytes;
  LittleEndian(bytes)
      .number(std::uint32_t{5})
      .number(std::uint32_t{1'700'000'000})
      .number(std::uint32_t{250})
      .text("left_optical")
      .number(std::uint32_t{2})
      .number(std::uint32_t{2})
      .text(encoding)
      .number(std::uint8_t{0})
      .number(step)
      .number(static_cast<std::uint32_t>(data.size()))
      .bytes(data);
  return bytes;
}

Bytes cdr_picture(const std::string& frame) {
  return CdrWriter()
      .number(std::uint32_t{1'700'000'000})
      .number(std::uint32_t{250})
      .text(frame)
      .number(std::uint32_t{2})
      .number(std::uint32_t{2})
      .text("bgr8")
      .number(std::uint8_t{0})
      .number(std::uint32_t{7})
      .array(kRows)
      .message();
}

Result<vision::Image> pixels(const McapRecording& recording, const Bytes& data) {
  const auto parsed = KAZ_TRY(parse_picture(recording, {1, 0, data}));
  return decode_message_picture(parsed, "picture");
}

TEST(PictureMessages, KnowsTheNamesOfRosAndFoxglove) {
  for (const auto& [schema, encoding, kind] :
       {std::tuple("sensor_msgs/Image", "ros1", Kind::raw),
        std::tuple("sensor_msgs/msg/Image", "cdr", Kind::raw),
        std::tuple("sensor_msgs/msg/CompressedImage", "cdr", Kind::compressed),
        std::tuple("foxglove_msgs/CompressedImage", "ros1", Kind::foxglove),
        std::tuple("foxglove.CompressedImage", "json", Kind::foxglove),
        std::tuple("foxglove.CameraCalibration", "json", Kind::camera_info),
        std::tuple("foxglove.CompressedImage", "protobuf", Kind::foxglove),
        std::tuple("sensor_msgs/msg/CameraInfo", "cdr", Kind::camera_info),
        std::tuple("sensor_msgs/msg/PointCloud2", "cdr", Kind::other),
        std::tuple("sensor_msgs/Image", "json", Kind::other),
        std::tuple("sensor_msgs/Image", "protobuf", Kind::other)}) {
    EXPECT_EQ(kind_of_channel(with_channel(schema, encoding), 1), kind) << schema << encoding;
  }
  EXPECT_EQ(channel_text(with_channel("a/B", "cdr"), 1), "/left/image_raw (a/B, cdr)");
}

TEST(PictureMessages, ReadsRawPicturesOfRos1AndCdr) {
  const auto ros1 = with_channel("sensor_msgs/Image", "ros1");
  const auto parsed = parse_picture(ros1, {1, 9, ros1_picture("rgb8", 7, kRows)});
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(parsed->stamp_ns, 1'700'000'000'000'000'250u);
  const auto rgb = pixels(ros1, ros1_picture("rgb8", 7, kRows));
  ASSERT_TRUE(rgb) << rgb.error().message;
  EXPECT_EQ(rgb->rgb, (Bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  const auto gray = pixels(ros1, ros1_picture("mono8", 2, {1, 2, 3, 4}));
  ASSERT_TRUE(gray) << gray.error().message;
  EXPECT_EQ(gray->rgb, (Bytes{1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4}));
  // Texts of all lengths, so that each alignment of the fields behind them occurs.
  for (const char* frame : {"", "a", "ab", "abc", "abcd"}) {
    const auto bgr = pixels(with_channel("sensor_msgs/msg/Image", "cdr"), cdr_picture(frame));
    ASSERT_TRUE(bgr) << bgr.error().message;
    EXPECT_EQ(bgr->rgb, (Bytes{3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10}));
  }
}

TEST(PictureMessages, ReadsCompressedPictures) {
  const Bytes samples = {1, 2, 3, 4, 5, 6};
  const auto png = picture::encode_png({.width = 2, .height = 1, .samples = samples}, {});
  ASSERT_TRUE(png);
  const Bytes file(png->begin(), png->end());
  const auto header = CdrWriter().number(std::uint32_t{3}).number(std::uint32_t{0}).text("eye");
  const auto cdr = pixels(with_channel("sensor_msgs/msg/CompressedImage", "cdr"),
                          CdrWriter(header).text("rgb8; png compressed").array(file).message());
  ASSERT_TRUE(cdr) << cdr.error().message;
  EXPECT_EQ(cdr->rgb, samples);
  const auto foxglove = pixels(with_channel("foxglove_msgs/msg/CompressedImage", "cdr"),
                               CdrWriter(header).array(file).text("png").message());
  ASSERT_TRUE(foxglove) << foxglove.error().message;
  EXPECT_EQ(foxglove->rgb, samples);
  // "P5 1 1 255\n" and a gray pixel, in base64.
  const std::string json =
      R"({"timestamp":{"sec":3,"nsec":4},"frame_id":"eye","format":"pgm","data":"UDUgMSAxIDI1NQpB"})";
  const auto recording = with_channel("foxglove.CompressedImage", "json");
  const auto parsed = parse_picture(recording, {1, 0, Bytes(json.begin(), json.end())});
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(parsed->stamp_ns, 3'000'000'004u);
  const auto gray = decode_message_picture(*parsed, "picture");
  ASSERT_TRUE(gray) << gray.error().message;
  EXPECT_EQ(gray->rgb, (Bytes{'A', 'A', 'A'}));
}

TEST(PictureMessages, RefusesDamageAndOtherEncodingsByName) {
  const auto ros1 = with_channel("sensor_msgs/Image", "ros1");
  Bytes cut = ros1_picture("rgb8", 7, kRows);
  cut.pop_back();
  const auto damaged = parse_picture(ros1, {1, 0, cut});
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message.find("sensor_msgs/Image"), std::string::npos);
  const auto depth = pixels(ros1, ros1_picture("16UC1", 4, kRows));
  ASSERT_FALSE(depth);
  EXPECT_EQ(depth.error().message.find("picture: the encoding 16UC1"), 0u) << depth.error().message;
  EXPECT_FALSE(pixels(ros1, ros1_picture("rgb8", 5, kRows))) << "a row has 6 bytes";
  EXPECT_FALSE(pixels(ros1, ros1_picture("rgb8", 8, kRows))) << "the data end early";
  Bytes other_cdr = cdr_picture("a");
  other_cdr[1] = 7;  // XCDR 2
  EXPECT_FALSE(parse_picture(with_channel("sensor_msgs/msg/Image", "cdr"), {1, 0, other_cdr}));
  const std::string json = R"({"data":"?"})";
  EXPECT_FALSE(parse_picture(with_channel("foxglove.CompressedImage", "json"),
                             {1, 0, Bytes(json.begin(), json.end())}));
}

TEST(PictureMessages, ReadsCameraInfo) {
  const std::vector<double> d{-0.3, 0.1, 0, 0, 0.5}, k{400, 0, 320, 0, 401, 240, 0, 0, 1},
      r{1, 0, 0, 0, 1, 0, 0, 0, 1}, p{400, 0, 320, -40, 0, 400, 240, 0, 0, 0, 1, 0};
  const auto message = [&](std::uint32_t binning, std::uint32_t roi_width) {
    CdrWriter cdr;
    cdr.number(std::uint32_t{3}).number(std::uint32_t{0}).text("eye");
    cdr.number(std::uint32_t{480}).number(std::uint32_t{640}).text("plumb_bob");
    cdr.number(std::uint32_t{5}).reals(d).reals(k).reals(r).reals(p);
    cdr.number(binning).number(binning);
    for (const std::uint32_t one : {0u, 0u, 0u, roi_width}) cdr.number(one);
    return cdr.number(std::uint8_t{0}).message();
  };
  const auto recording = with_channel("sensor_msgs/msg/CameraInfo", "cdr");
  const auto info = parse_camera_info_message(recording, {1, 0, message(0, 0)});
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->width, 640u);
  EXPECT_EQ(info->height, 480u);
  EXPECT_EQ(info->model, "plumb_bob");
  EXPECT_EQ(info->d, d);
  EXPECT_EQ(info->k, k);
  EXPECT_EQ(info->r, r);
  EXPECT_EQ(info->p, p);
  EXPECT_TRUE(parse_camera_info_message(recording, {1, 0, message(1, 640)}));
  EXPECT_FALSE(parse_camera_info_message(recording, {1, 0, message(2, 0)})) << "binned";
  EXPECT_FALSE(parse_camera_info_message(recording, {1, 0, message(0, 320)})) << "a part";
  const std::string json =
      R"({"width":640,"height":480,"distortion_model":"plumb_bob","D":[1],"K":[400,0.5],"R":[],"P":[7]})";
  const auto foxglove = parse_camera_info_message(
      with_channel("foxglove.CameraCalibration", "json"), {1, 0, Bytes(json.begin(), json.end())});
  ASSERT_TRUE(foxglove) << foxglove.error().message;
  EXPECT_EQ(foxglove->width, 640u);
  EXPECT_EQ(foxglove->k, (std::vector<double>{400, 0.5}));
}

TEST(PictureMessages, ReadsProtobufOfFoxglove) {
  // Field 1: a time; 4: the frame; 2: "P5 1 1 255\nA"; 15: an unknown number; 3: the format.
  Bytes message{0x0A, 4, 0x08, 3, 0x10, 4, 0x22, 1, 'f', 0x12, 12};
  for (const char c : std::string("P5 1 1 255\nA")) message.push_back(static_cast<std::uint8_t>(c));
  for (const std::uint8_t byte : {0x78, 0x96, 0x01, 0x1A, 0x01, 0x70}) message.push_back(byte);
  const auto recording = with_channel("foxglove.CompressedImage", "protobuf");
  const auto parsed = parse_picture(recording, {1, 0, message});
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(parsed->stamp_ns, 3'000'000'004u);
  const auto gray = decode_message_picture(*parsed, "picture");
  ASSERT_TRUE(gray) << gray.error().message;
  EXPECT_EQ(gray->rgb, (Bytes{'A', 'A', 'A'}));
  message.pop_back();
  EXPECT_FALSE(parse_picture(recording, {1, 0, message})) << "the last field is cut off";
  EXPECT_FALSE(parse_picture(recording, {1, 0, Bytes(11, 0xFF)})) << "a varint without an end";

  // width, height, model, K packed, P in two fields.
  Bytes info{0x15, 64, 0, 0, 0, 0x1D, 48, 0, 0, 0, 0x22, 1, 'x', 0x32, 16};
  LittleEndian(info).real(400).real(0.5).number(std::uint8_t{0x41}).real(7);
  LittleEndian(info).number(std::uint8_t{0x41}).real(8);
  const auto read = parse_camera_info_message(
      with_channel("foxglove.CameraCalibration", "protobuf"), {1, 0, info});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 64u);
  EXPECT_EQ(read->height, 48u);
  EXPECT_EQ(read->model, "x");
  EXPECT_EQ(read->k, (std::vector<double>{400, 0.5}));
  EXPECT_EQ(read->p, (std::vector<double>{7, 8}));
}

TEST(MessageFields, ReadsBigEndianCdr) {
  const Bytes message{0, 0, 0, 0, 0x12, 0xEE, 0xEE, 0xEE, 1, 2, 3, 4};
  MessageFields fields(MessageFields::Wire::cdr, message);
  EXPECT_EQ(fields.number<std::uint8_t>(), 0x12);
  EXPECT_EQ(fields.number<std::uint32_t>(), 0x01020304u);
  EXPECT_TRUE(fields.good());
  EXPECT_EQ(fields.number<std::uint8_t>(), 0);
  EXPECT_FALSE(fields.good());
}

}  // namespace
}  // namespace kaz::sim
