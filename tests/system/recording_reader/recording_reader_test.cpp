// A recording of `kaz run` read by the npm package of MCAP: same messages as our own reader, valid
// checksums, schemas that decode.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/formats/mcap_writer.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using sim::McapRecording;

Finished read_by_npm(const std::string& file) {
  return run({KAZ_NODE, KAZ_READER, file}, std::chrono::seconds(60));
}

double real_at(const McapRecording::Message& message, std::size_t index) {
  double value = 0;
  std::memcpy(&value, message.data.data() + 8 * index, sizeof value);
  return value;
}

// One recording for all cases.
class RecordingReader : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const auto made = run(kaz({"run", "search-ball", "--mcu", "native", "--record-pictures",
                               "--out", *folder_ / "out"}),
                          std::chrono::seconds(100));
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  void SetUp() override {
    ASSERT_TRUE(std::ifstream(KAZ_NPM_STAMP).good())
        << "the packages of npm are not there: run ./tools/dev build with the network up";
  }
  static std::string file() { return *folder_ / "out/recording.mcap"; }
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(RecordingReader, FindsWhatOurOwnReaderFinds) {
  const auto own = McapRecording::load(file());
  ASSERT_TRUE(own) << own.error().message;
  std::map<std::string, int> counts;
  std::map<std::string, const McapRecording::Message*> first, earliest;
  for (const auto& message : own->messages) {
    const std::string& topic = own->topics.at(message.channel);
    ++counts[topic];
    auto& found = earliest[topic];
    if (found == nullptr || message.time_ns < found->time_ns) found = &message;
  }

  const Finished read = read_by_npm(file());
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const json result = parse_json(read.out);
  const json &stream = result["stream"], &indexed = result["indexed"];
  EXPECT_EQ(stream["counts"], json(counts));
  EXPECT_EQ(indexed["counts"], json(counts));
  for (const auto& [topic, count] : indexed["statistics"].items())
    EXPECT_EQ(count, counts.contains(topic) ? counts[topic] : 0) << topic;
  EXPECT_EQ(indexed["metadata"]["kaz"], json(own->facts));
  EXPECT_EQ(indexed["in_order"], true);

  // Each chunk has a checksum and is in the index.
  const int chunks = stream["chunks"];
  EXPECT_GT(chunks, 1);
  EXPECT_EQ(stream["checked"], chunks);
  EXPECT_EQ(indexed["chunk_indexes"], chunks);

  // Each channel with messages was decoded by its schema; read.mjs fails where that cannot be.
  const json& channels = indexed["channels"];
  EXPECT_EQ(channels.size(), counts.size());
  for (const char* topic : {"/wire/to_board", "/wire/to_host", "/board/pins", "/board/analog",
                            "/truth/joints", "/truth/ball", "/board/supply", "/truth/contacts",
                            "/truth/link_forces", "/truth/joint_loads", "/eyes", "/eyes/left",
                            "/eyes/right", "/behavior", "/tf", "/contacts"})
    EXPECT_TRUE(channels.contains(topic)) << topic;
  for (const auto& [topic, channel] : channels.items())
    EXPECT_EQ(channel["first_time_ns"], std::to_string(earliest.at(topic)->time_ns)) << topic;
}

TEST_F(RecordingReader, DecodesTheNumbersThatWereWritten) {
  const auto own = McapRecording::load(file());
  ASSERT_TRUE(own) << own.error().message;
  const auto first = [&](const std::string& topic) {
    for (const auto& message : own->messages)
      if (own->topics.at(message.channel) == topic) return message;
    return McapRecording::Message{};
  };
  const Finished read = read_by_npm(file());
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const json result = parse_json(read.out);
  const json& channels = result["indexed"]["channels"];

  const auto joints = first("/truth/joints");
  const json& decoded = channels["/truth/joints"]["first"];
  ASSERT_EQ(decoded["angle"].size(), 18u);
  for (std::size_t j = 0; j < 18; ++j) {
    EXPECT_EQ(decoded["angle"][j].get<double>(), real_at(joints, j));
    EXPECT_EQ(decoded["torque"][j].get<double>(), real_at(joints, 18 + j));
    EXPECT_EQ(decoded["winding_celsius"][j].get<double>(), real_at(joints, 36 + j));
    EXPECT_NEAR(decoded["winding_celsius"][j].get<double>(), 25, 1);  // a millisecond after cold
  }
  // It is set down on its feet: only floor and soles touch, and the floor pushes up.
  const auto loads = first("/truth/joint_loads");
  const json& borne = channels["/truth/joint_loads"]["first"];
  ASSERT_EQ(borne["force"].size(), 54u);
  for (std::size_t k = 0; k < 54; ++k)
    EXPECT_EQ(borne["moment"][k].get<double>(), real_at(loads, 54 + k));
  EXPECT_GT(borne["force"][2].get<double>(), 0.3) << "the neck bears a head of 80 g";
  const auto supply = first("/board/supply");
  EXPECT_EQ(channels["/board/supply"]["first"]["volts"].get<double>(), real_at(supply, 0));
  // The first bytes of a host: a frame, from zero to zero.
  const json& wire = channels["/wire/to_board"]["first"];
  EXPECT_EQ(wire["value"][0], 0);
  EXPECT_EQ(wire["value"].size(), wire["state"].size());
  EXPECT_EQ(wire["value"].size(), wire["framing_error"].size());
  EXPECT_EQ(channels["/eyes"]["first"]["left_xxh3"].get<std::string>().size(), 32u);
  EXPECT_TRUE(channels["/behavior"]["first"].is_object());
  const json& picture = channels["/eyes/left"]["first"];
  EXPECT_EQ(picture["format"], "png");
  EXPECT_EQ(picture["data"][1], 'P');
  EXPECT_EQ(picture["header"]["stamp"]["nsec"], 33'000'000);
}

// As viewers of ROS draw them: a box 7 cm to each side of (0.55, 0.12), free floor to its right.
TEST_F(RecordingReader, DecodesMapAndPath) {
  const std::string out = *folder_ / "navigated";
  const Finished made = run(kaz({"run", "navigate", "--goal", "0.5,-0.15", "--world", "boxes",
                                 "--eyes", "real", "--imu", "--mcu", "native", "--out", out}),
                            std::chrono::seconds(100));
  ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  const Finished read = read_by_npm(out + "/recording.mcap");
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const json result = parse_json(read.out);
  const json& channels = result["indexed"]["channels"];
  EXPECT_EQ(channels["/map"]["schema"], "nav_msgs/OccupancyGrid");
  const json& map = channels["/map"]["first"];
  EXPECT_EQ(map["header"]["frame_id"], "map");
  const json& info = map["info"];
  const double cell = info["resolution"].get<double>();
  EXPECT_NEAR(cell, 0.01, 1e-6);
  const int width = info["width"].get<int>();
  ASSERT_EQ(map["data"].size(), static_cast<std::size_t>(width * info["height"].get<int>()));
  const auto at = [&](double x, double y) {
    const json& origin = info["origin"]["position"];
    const int column = static_cast<int>((x - origin["x"].get<double>()) / cell),
              row = static_cast<int>((y - origin["y"].get<double>()) / cell);
    return map["data"][static_cast<std::size_t>(row * width + column)].get<int>();
  };
  int obstacles = 0, floor = 0;
  for (int i = -6; i <= 6; ++i) {
    for (int j = -6; j <= 6; ++j) {
      obstacles += at(0.49 + 0.01 * i, 0.12 + 0.01 * j) > 50 ? 1 : 0;
      const int free = at(0.5 + 0.01 * i, -0.15 + 0.01 * j);
      floor += free >= 0 && free < 50 ? 1 : 0;
    }
  }
  EXPECT_GT(obstacles, 12);
  // Where the robot starts in the world, the map's frame is.
  const json& placed = channels["/tf"]["of_map"];
  EXPECT_EQ(placed["header"]["frame_id"], "world");
  EXPECT_EQ(placed["transform"]["translation"]["x"], 0);
  EXPECT_EQ(placed["transform"]["rotation"]["w"], 1);
  EXPECT_GT(floor, 160);
  EXPECT_EQ(at(-1.9, 1.9), -1);

  EXPECT_EQ(channels["/map/path"]["schema"], "nav_msgs/Path");
  const json& poses = channels["/map/path"]["first"]["poses"];
  ASSERT_GE(poses.size(), 2u);
  EXPECT_NEAR(poses.front()["pose"]["position"]["x"].get<double>(), 0, 0.03);
  EXPECT_NEAR(poses.back()["pose"]["position"]["x"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(poses.back()["pose"]["position"]["y"].get<double>(), -0.15, 1e-9);
  EXPECT_EQ(channels["/map/robot"]["schema"], "geometry_msgs/PoseStamped");
  EXPECT_NEAR(channels["/map/robot"]["first"]["pose"]["orientation"]["w"].get<double>(), 1, 0.01);
}

TEST_F(RecordingReader, RefusesOneFlippedBit) {
  const std::string damaged = *folder_ / "damaged.mcap";
  std::string bytes = read_file(file());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_file(damaged, bytes);
  const Finished read = read_by_npm(damaged);
  EXPECT_EQ(read.exit_code, 1);
  EXPECT_NE(read.err.find("CRC"), std::string::npos) << read.err;
}

}  // namespace
}  // namespace kaz::test
