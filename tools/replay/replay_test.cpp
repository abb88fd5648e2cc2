// Recordings read back: how a run was put together, and where two runs differ.
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay.h"
#include "shared/base/json_testing.h"

#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tools/replay/message_fields.h"
#include "tools/replay/recorded_backend.h"

namespace kaz::tools {
namespace {

sim::McapRecording with_backend(const std::string& backend) {
  sim::McapRecording recording;
  recording.facts = {
      {"behavior", "track-ball"}, {"settings", R"({"seconds":"5"})"}, {"backend", backend}};
  return recording;
}

TEST(RecordedBackend, ReadsTheBallThatWasLookedFor) {
  auto recording =
      with_backend(R"({"world":"catch","mcu":"native","sensors":"ideal","eyes":"ideal"})");
  const auto usual = recorded_backend(recording, "run.mcap");
  ASSERT_TRUE(usual) << usual.error().message;
  EXPECT_EQ(usual->ball.radius_m, vision::BallOptions{}.radius_m);
  recording.facts["ball"] = R"({"hue_min":1.5,"hue_max":2.0,"y_min":9,"radius_m":0.018})";
  const auto green = recorded_backend(recording, "run.mcap");
  ASSERT_TRUE(green) << green.error().message;
  EXPECT_EQ(green->ball.color.hue_min, 1.5);
  EXPECT_EQ(green->ball.color.y_min, 9);
  EXPECT_EQ(green->ball.radius_m, 0.018);
  for (const char* bad : {"[]", R"({"hue_min":1,"hue_max":2})", R"({"y_min":9,"radius_m":7})"}) {
    recording.facts["ball"] = bad;
    const auto none = recorded_backend(recording, "run.mcap");
    ASSERT_FALSE(none) << bad;
    EXPECT_NE(none.error().message.find("ball"), std::string::npos) << none.error().message;
  }
}

// Another's world is where the recording is, or where its run was started: beside the run's folder.
TEST(RecordedBackend, FindsFilesBesideTheRecordingOrItsFolder) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "kaz_find_beside";
  fs::remove_all(folder);
  fs::create_directories(folder / "out");
  const std::string recording = (folder / "out/recording.mcap").string();
  BackendOptions options;
  options.world = "mine.sdf";
  find_beside(options, recording);
  EXPECT_EQ(options.world, "mine.sdf") << "it is nowhere";
  std::ofstream(folder / "mine.sdf") << "<sdf/>";
  find_beside(options, recording);
  EXPECT_TRUE(fs::equivalent(options.world, folder / "mine.sdf")) << options.world;
  std::ofstream(folder / "out/mine.sdf") << "<sdf/>";
  options.world = "worlds/mine.sdf";
  find_beside(options, recording);
  EXPECT_TRUE(fs::equivalent(options.world, folder / "out/mine.sdf")) << options.world;
  options.world = "boxes";
  find_beside(options, recording);
  EXPECT_EQ(options.world, "boxes");
  fs::remove_all(folder);
}

TEST(RecordedBackend, ReadsEachKey) {
  const auto read = recorded_backend(
      with_backend(R"({"world":"catch","robot_file":"r.urdf","mcu":"native","image":"kaz.mot",
                       "sensors":"ideal","imu":true,"dynamics":"exact","physics_step_ms":0.5,
                       "eyes":"real","eye_width":640,"renderer":"raster","supply_volts":9.5,"seed":7,
                       "memory":"ff00","suspended":true,"joints":["turn","jaw"],
                       "joint_speeds":["2","12"]})"),
      "run.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->behavior, "track-ball");
  EXPECT_EQ(read->settings.at("seconds"), "5");
  EXPECT_EQ(read->backend.world, "catch");
  EXPECT_EQ(read->backend.robot_file, "r.urdf");
  EXPECT_EQ(read->backend.joints, (std::vector<std::string>{"turn", "jaw"}));
  EXPECT_EQ(read->backend.joint_speeds, (std::vector<std::string>{"2", "12"}));
  EXPECT_EQ(read->backend.mcu, sim::McuKind::native);
  EXPECT_EQ(read->backend.image, "kaz.mot");
  EXPECT_EQ(read->backend.sensors, sim::SensorSet::ideal);
  EXPECT_TRUE(read->backend.imu);
  EXPECT_EQ(read->backend.dynamics, "exact");
  EXPECT_EQ(read->backend.physics_step_ms, 0.5);
  EXPECT_EQ(read->backend.eyes, sim::EyeKind::real);
  EXPECT_EQ(read->backend.eye_width, 640);
  EXPECT_EQ(read->backend.renderer, sim::RendererKind::raster);
  EXPECT_EQ(read->backend.supply_volts, 9.5);
  EXPECT_EQ(read->backend.seed, 7u);
  EXPECT_EQ(read->backend.memory, "ff00");
  EXPECT_TRUE(read->backend.suspended);
}

TEST(RecordedBackend, ItsErrorsAreShortAndHaveOneLine) {
  const std::string long_text = "\r\n" + std::string(5000, 'a');
  auto recording = with_backend("{}");
  for (const char* fact : {"port", "settings", "backend"}) {
    const bool is_port = std::string_view(fact) == "port";
    auto hostile = recording;
    hostile.facts[fact] = is_port ? long_text : nlohmann::json{{long_text, 1}}.dump();
    const auto read = recorded_backend(hostile, "run.mcap");
    ASSERT_FALSE(read) << fact;
    EXPECT_LT(read.error().message.size(), 400u) << fact;
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos) << read.error().message;
  }
}

TEST(RecordedBackend, ReadsTheMcuOfOlderRecordings) {
  const auto read = recorded_backend(
      with_backend(R"({"world":"ball","engine":"native","sensors":"nominal","eyes":"ideal"})"),
      "old.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->backend.mcu, sim::McuKind::native);
}

TEST(RecordedBackend, RecordingsWithoutARendererAreOfOpenGl) {
  const std::string same = R"("world":"ball","mcu":"native","sensors":"nominal","eyes":"ideal")";
  const auto read = recorded_backend(with_backend("{" + same + "}"), "old.mcap");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->backend.renderer, sim::RendererKind::opengl);
  const auto other =
      recorded_backend(with_backend("{" + same + R"(,"renderer":"vulkan"})"), "other.mcap");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("`renderer`"), std::string::npos) << other.error().message;
}

TEST(RecordedBackend, NamesTheKeyOfAnotherKind) {
  for (const char* backend :
       {R"({"mcu":1})", R"({"engine":1})", R"({"imu":"yes"})", R"({"seed":-1})",
        R"({"eye_width":5000})", R"({"physics_step_ms":"1"})", R"({"supply_volts":1e300})",
        R"({"supply_volts":-10})"}) {
    const auto read = recorded_backend(with_backend(backend), "run.mcap");
    ASSERT_FALSE(read) << backend;
    EXPECT_EQ(read.error().fault, Fault::usage);
    const std::string text(backend);
    const std::string key = text.substr(2, text.find('"', 2) - 2);
    EXPECT_NE(read.error().message.find("`" + key + "`"), std::string::npos)
        << read.error().message;
  }
}

TEST(RecordedBackend, NamesTheKeyThatIsMissing) {
  const nlohmann::json whole{
      {"world", "ball"}, {"mcu", "h8"}, {"sensors", "nominal"}, {"eyes", "ideal"}};
  ASSERT_TRUE(recorded_backend(with_backend(whole.dump()), "run.mcap"));
  for (const auto& [key, value] : whole.items()) {
    nlohmann::json without = whole;
    without.erase(key);
    const auto read = recorded_backend(with_backend(without.dump()), "run.mcap");
    ASSERT_FALSE(read) << key;
    EXPECT_EQ(read.error().fault, Fault::usage);
    EXPECT_NE(read.error().message.find("`" + key + "`"), std::string::npos)
        << read.error().message;
  }
}

TEST(RecordedBackend, NamesTheKeyTheValueAndTheValidOnes) {
  const struct {
    const char *key, *value, *valid;
  } cases[] = {{"mcu", "z80", "must be one of h8, native"},
               {"sensors", "perfect", "must be one of nominal, ideal, as-built"},
               {"eyes", "Real", "must be one of ideal, real"}};
  for (const auto& [key, value, valid] : cases) {
    nlohmann::json backend{
        {"world", "ball"}, {"mcu", "h8"}, {"sensors", "nominal"}, {"eyes", "ideal"}};
    backend[key] = value;
    const auto read = recorded_backend(with_backend(backend.dump()), "run.mcap");
    ASSERT_FALSE(read) << key;
    EXPECT_EQ(read.error().fault, Fault::usage);
    for (const std::string& part : {"`" + std::string(key) + "`", "`" + std::string(value) + "`",
                                    std::string(valid), std::string("run.mcap")})
      EXPECT_NE(read.error().message.find(part), std::string::npos) << read.error().message;
  }
}

TEST(RecordedBackend, RefusesARecordingWithoutBehavior) {
  EXPECT_FALSE(recorded_backend(sim::McapRecording{}, "run.mcap"));
  EXPECT_FALSE(recorded_backend(with_backend("[]"), "run.mcap"));
}

std::vector<std::uint8_t> doubles(std::initializer_list<double> values) {
  std::vector<std::uint8_t> bytes;
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::uint8_t>(bits >> 8 * k));
  }
  return bytes;
}

TEST(FieldDifference, IsTheFirstFieldThatDiffers) {
  const auto difference =
      field_difference("/truth/ball", doubles({1, 2, 3}), doubles({1, 2.5, 3.5}));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->recorded, "y = 2");
  EXPECT_EQ(difference->now, "y = 2.5 (1 more numbers differ)");
}

TEST(FieldDifference, IsNothingForOtherChannelsAndLengths) {
  EXPECT_FALSE(field_difference("/behavior", doubles({1}), doubles({2})));
  EXPECT_FALSE(field_difference("/truth/ball", doubles({1, 2}), doubles({1, 3})));
  EXPECT_FALSE(field_difference("/truth/ball", doubles({1, 2, 3}), doubles({1, 2})));
}

sim::McapRecording ball_at(std::initializer_list<double> x) {
  sim::McapRecording recording;
  recording.topics = {{1, "/truth/ball"}};
  recording.whole = true;
  std::uint64_t time_ns = 0;
  for (const double value : x) {
    recording.messages.push_back({1, time_ns, doubles({value, 0, 0})});
    time_ns += 1'000'000'000;
  }
  return recording;
}

TEST(FirstDifference, IsNoneBetweenEqualRecordings) {
  EXPECT_FALSE(first_difference(ball_at({1, 2}), ball_at({1, 2})));
}

TEST(FirstDifference, HasTimeTopicAndField) {
  const auto difference = first_difference(ball_at({1, 2, 3}), ball_at({1, 4, 5}));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->time_s, 1);
  EXPECT_EQ(difference->topic, "/truth/ball");
  EXPECT_EQ(difference->recorded, "x = 2");
  EXPECT_EQ(difference->now, "x = 4");
}

TEST(FirstDifference, IsAMissingMessageUnlessTheRecordingWasCutOff) {
  const auto missing = first_difference(ball_at({1, 2}), ball_at({1}));
  ASSERT_TRUE(missing);
  EXPECT_EQ(missing->now, "nothing");
  const auto more = first_difference(ball_at({1}), ball_at({1, 2}));
  ASSERT_TRUE(more);
  EXPECT_EQ(more->recorded, "nothing");
  sim::McapRecording cut_off = ball_at({1});
  cut_off.whole = false;
  EXPECT_FALSE(first_difference(cut_off, ball_at({1, 2})));
}

TEST(PrintInterrupted, IsJsonWithProvenanceAndOnlyThen) {
  const auto printed = [](const Error& error, bool json) {
    ReplayOptions options;
    options.file = "run.mcap";
    options.json = json;
    testing::internal::CaptureStdout();
    print_interrupted(error, options, "host");
    return testing::internal::GetCapturedStdout();
  };
  const Error interrupted{Fault::interrupted, "interrupted"};
  const auto result = parse_json(printed(interrupted, true));
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["recording"], "run.mcap");
  EXPECT_EQ(result["mode"], "host");
  EXPECT_EQ(result["interrupted"], true);
  for (const char* key : {"date", "kaz", "command"})
    EXPECT_TRUE(result["provenance"].contains(key)) << key << result;
  EXPECT_EQ(printed(interrupted, false), "");
  EXPECT_EQ(printed({Fault::usage, "damaged"}, true), "");
}

}  // namespace
}  // namespace kaz::tools
