// result.json of a run: what is in it, and where it cannot be written.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>

#include "shared/base/files.hpp"
#include "shared/board/board.h"
#include "tools/base/provenance.h"
#include "tools/base/version.h"
#include "tools/run/live_camera.h"

namespace kaz::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// Of a run at a port: no simulation, no pictures of moments.
class Report : public testing::Test {
 protected:
  Report() : folder_(make_temporary_folder("kaz-report-").value()) {
    report_.behavior = "track-ball";
    report_.backend.robot = "serial:/dev/ttyUSB0";
    report_.backend.seed = 7;
    report_.outcome.success = true;
    report_.outcome.sentence = "the ball was tracked";
    report_.run_s = 5.00049;
    report_.rtf = 1.0004;
    report_.score.measured_by = "pictures";
  }
  ~Report() override {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  std::string at(const std::string& name) const { return folder_ + "/" + name; }
  std::string read(const std::string& name) const {
    std::ifstream file(at(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  Result<ordered_json> written(const std::string& out) {
    if (out.empty()) return write_report(report_, nullptr, snapshots_, nullptr, false);
    const auto folder = KAZ_TRY(OutputFolder::begin(out, run_output()));
    return write_report(report_, nullptr, snapshots_, &folder, false);
  }
  // Without files.
  ordered_json result() {
    const auto made = written("");
    EXPECT_TRUE(made) << made.error().message;
    return made.value_or(ordered_json());
  }

  std::string folder_;
  behavior::Recording recording_;
  BehaviorReport report_{.recording = recording_};
  NoCamera no_camera_;
  RunObserver observer_;
  RememberingCamera camera_{no_camera_, observer_};
  Snapshots snapshots_{camera_, nullptr, vision::BallOptions{}};
};

TEST_F(Report, HasOutcomeAndRobot) {
  const ordered_json json = result();
  EXPECT_EQ(json["outcome"], "done");
  EXPECT_EQ(json["sentence"], "the ball was tracked");
  EXPECT_EQ(json["behavior"], "track-ball");
  EXPECT_EQ(json["robot"], "serial:/dev/ttyUSB0");
  EXPECT_FALSE(json.contains("mcu")) << "not known of a board at a port";
  EXPECT_EQ(json["seed"], 7);
  EXPECT_NEAR(json["duration_s"].get<double>(), 5.0, 1e-9);
  EXPECT_NEAR(json["rtf"].get<double>(), 1.0, 1e-9);
  EXPECT_FALSE(json.contains("tracking_from_s"));
  EXPECT_FALSE(json.contains("cause"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Report, HasTheCauseOfAFailure) {
  report_.outcome.success = false;
  report_.outcome.cause = "not found";
  const ordered_json json = result();
  EXPECT_EQ(json["outcome"], "failed");
  EXPECT_EQ(json["cause"], "not found");
}

TEST_F(Report, OfALateMachineBlamesNotTheRobot) {
  report_.outcome.success = false;
  report_.outcome.cause = "not found";
  report_.machine_failed = true;
  report_.lateness = RunLateness{4.25, 0.5, 0.125, "the program at the other end fell behind"};
  ordered_json json = result();
  EXPECT_EQ(json["outcome"], "environment");
  EXPECT_FALSE(json.contains("cause"));
  EXPECT_EQ(json["lateness"],
            (ordered_json{
                {"simulator_lost_s", 4.25}, {"host_late_s", 0.5}, {"host_worst_late_s", 0.125}}));
  report_.lateness->simulator_lost_s.reset();
  json = result();
  EXPECT_FALSE(json["lateness"].contains("simulator_lost_s"));
}

TEST_F(Report, HasTheScore) {
  report_.score.found_s = 1.23456;
  report_.score.within_3deg = 0.98765;
  report_.score.rms_deg = 1.00004;
  const ordered_json json = result();
  EXPECT_NEAR(json["tracking_from_s"].get<double>(), 1.235, 1e-9);
  EXPECT_NEAR(json["tracking_within_3deg"].get<double>(), 0.9877, 1e-9);
  EXPECT_NEAR(json["tracking_rms_deg"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(json["tracking_measured_by"], "pictures");
}

TEST_F(Report, PrintsEachShareOfTheTrackingOnce) {
  const auto first_line = [this] {
    testing::internal::CaptureStdout();
    print_report(result(), report_, "", false);
    const std::string out = testing::internal::GetCapturedStdout();
    return out.substr(0, out.find('\n'));
  };
  EXPECT_EQ(first_line(), "done: the ball was tracked");
  report_.score.found_s = 1;
  report_.score.within_3deg = 0.98214;
  EXPECT_EQ(first_line(),
            "done: the ball was tracked; after the ball was found, within 3 degrees of the image "
            "center: by vision 98.2 %");
  report_.outcome.measurements = {{"tracking_within_3deg", 0.98}};
  EXPECT_EQ(first_line(), "done: the ball was tracked") << "its sentence has that";
  report_.score.measured_by = "truth";
  EXPECT_EQ(first_line(), "done: the ball was tracked, by ground truth 98.2 %");
}

TEST_F(Report, HasNothingThatWasNotMeasured) {
  const ordered_json json = result();
  for (const char* name : {"tracking_within_3deg", "tracking_rms_deg", "tracking_measured_by",
                           "lateness", "vision", "faults_not_begun"})
    EXPECT_FALSE(json.contains(name)) << name;
  EXPECT_FALSE(json["board"].contains("worst_tick_share")) << "it counts no states";
  EXPECT_FALSE(json["link"].contains("round_trip_s")) << "nothing has answered";
  EXPECT_EQ(json["link"]["replies"], 0) << "a count is 0 where nothing happened";
}

TEST_F(Report, HasItsProvenance) {
  const char* const words[] = {"kaz", "run", "stand", "--out", "my folder", "it's\n"};
  set_command_line(6, words);
  const ordered_json from = result()["provenance"];
  EXPECT_EQ(from["command"], "kaz run stand --out 'my folder' 'it'\\''s '");
  EXPECT_EQ(from["kaz"], kVersion);
  EXPECT_TRUE(std::regex_match(from["date"].get<std::string>(),
                               std::regex("20[0-9]{2}-[01][0-9]-[0-3][0-9]T[0-9:]{8}Z")));
  EXPECT_FALSE(from["machine"]["cpu"].get<std::string>().empty());
  EXPECT_GT(from["machine"]["cores"].get<int>(), 0);
  EXPECT_EQ(from["machine"]["os"].get<std::string>().find('\n'), std::string::npos);
}

// Those of the report itself are not overwritten by the behavior's of the same name, unless null.
TEST_F(Report, HasTheBehaviorsMeasurements) {
  report_.outcome.measurements = {{"turned_deg", 1.2345678}, {"seed", 99}, {"found_s", 2.5}};
  const ordered_json json = result();
  EXPECT_NEAR(json["turned_deg"].get<double>(), 1.234568, 1e-9);
  EXPECT_EQ(json["seed"], 7);
  EXPECT_NEAR(json["found_s"].get<double>(), 2.5, 1e-9);
}

TEST_F(Report, HasBoardAndLink) {
  report_.identity.firmware_version = 0x0102;
  report_.identity.build_id = 12345;
  report_.health.worst_8states = KZ_STATES_PER_TICK / 8 / 2;
  report_.health.missed_ticks = 3;
  report_.health.bad_check = 1;
  report_.health.bad_stuffing = 2;
  report_.health.too_short = 4;
  report_.health.too_long = 8;
  report_.health.line_errors = 16;
  report_.link.requests = 100;
  report_.link.replies = 95;
  report_.link.timeouts = 5;
  report_.link.round_trip.max_s = 0.0123456;
  const ordered_json json = result();
  EXPECT_EQ(json["board"]["firmware"], "1.2");
  EXPECT_EQ(json["board"]["build"], "00003039");
  EXPECT_NEAR(json["board"]["worst_tick_share"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(json["board"]["missed_ticks"], 3);
  EXPECT_EQ(json["board"]["bad_frames"], 31);
  EXPECT_EQ(json["link"]["requests"], 100);
  EXPECT_EQ(json["link"]["timeouts"], 5);
  EXPECT_NEAR(json["link"]["round_trip_max_s"].get<double>(), 0.012346, 1e-9);
}

TEST_F(Report, FillsItsFolder) {
  report_.vision_table = "frame,found\n0,1\n";
  const auto json = written(at("out"));
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ(ordered_json::parse(read("out/result.json")), *json);
  EXPECT_EQ(read("out/vision.csv"), report_.vision_table);
  EXPECT_EQ((*json)["pictures"], ordered_json::array());
  EXPECT_FALSE(json->contains("recording"));
}

TEST_F(Report, PlotsARunWithCycles) {
  for (int i = 0; i < 3; ++i) {
    behavior::CycleRow row;
    row.time = std::chrono::milliseconds(10 * i);
    row.pan_target = 0.1 * i;
    recording_.cycle(row);
  }
  report_.score.time_s = {0, 0.01, 0.02};
  report_.score.error_deg = {1, 2, 3};
  const auto json = written(at("out"));
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ((*json)["pictures"], (ordered_json{"pan_tilt.png", "pan_tilt.svg"}));
  EXPECT_NE(read("out/pan_tilt.svg").find("track-ball over serial:/dev/ttyUSB0"),
            std::string::npos);
  EXPECT_GT(fs::file_size(at("out/pan_tilt.png")), 1000u);
}

TEST_F(Report, DrawsNothingWhereThereIsNothingToDraw) {
  // A picture without the ball has an error that is no number.
  report_.score.time_s = {0, 0.1};
  report_.score.error_deg = {std::nan(""), std::nan("")};
  const auto json = written(at("out"));
  ASSERT_TRUE(json) << json.error().message;
  EXPECT_EQ((*json)["pictures"], ordered_json::array());
  EXPECT_TRUE((*json)["not_drawn"].contains("pan_tilt.png"));
  EXPECT_FALSE(fs::exists(at("out/pan_tilt.png")));
  testing::internal::CaptureStdout();
  print_report(*json, report_, at("out"), false);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("no pan_tilt.png: "), std::string::npos);
  // A behavior that does not look has nothing to report about the ball.
  report_.looks = false;
  const auto blind = written(at("blind"));
  ASSERT_TRUE(blind) << blind.error().message;
  EXPECT_FALSE(blind->contains("not_drawn"));
}

TEST_F(Report, ThinsTheTrackingErrorToTenSamplesASecond) {
  report_.score.time_s = {0, 0.05, 0.1, 0.15, 0.2};
  report_.score.error_deg = {1, 2, 3, 4, std::numeric_limits<double>::quiet_NaN()};
  const auto json = written(at("out"));
  ASSERT_TRUE(json) << json.error().message;
  const ordered_json& rows = (*json)["tracking_error"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NEAR(rows[0]["deg"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(rows[1]["t_s"].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(rows[1]["deg"].get<double>(), 3, 1e-9);
  EXPECT_TRUE(rows[2]["deg"].is_null()) << "the ball was not in the picture";
}

TEST_F(Report, NamesTheFolderThatCannotBeMade) {
  std::ofstream(at("file")) << "x";
  for (const char* out : {"file", "file/below"}) {
    const auto json = written(at(out));
    ASSERT_FALSE(json) << out;
    EXPECT_EQ(json.error().fault, Fault::usage);
    EXPECT_NE(json.error().message.find(at(out)), std::string::npos) << json.error().message;
    EXPECT_NE(json.error().message.find("--out"), std::string::npos) << json.error().message;
  }
  EXPECT_EQ(read("file"), "x");
}

// A folder in the place of a file that belongs into the results.
TEST_F(Report, LeavesNoResultWhereAFileCannotBeWritten) {
  const auto folder = OutputFolder::begin(at("out"), run_output());
  ASSERT_TRUE(folder);
  fs::create_directories(at("out/vision.csv/in the way"));
  const auto json = write_report(report_, nullptr, snapshots_, &*folder, false);
  ASSERT_FALSE(json);
  EXPECT_NE(json.error().message.find("vision.csv"), std::string::npos) << json.error().message;
  EXPECT_FALSE(fs::exists(at("out/result.json")));
}

}  // namespace
}  // namespace kaz::tools
