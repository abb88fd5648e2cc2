// `kaz calibrate joints` as a user runs it, judged by the potentiometers' truth.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/angle.hpp"
#include "shared/base/json_testing.h"
#include "shared/board/table.h"
#include "sim/board/potentiometer.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::seconds;

std::vector<std::string> calibrate(std::vector<std::string> more) {
  std::vector<std::string> arguments{"calibrate", "joints"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return kaz(arguments);
}

std::vector<std::string> on_native(const std::string& seed, std::vector<std::string> more) {
  std::vector<std::string> arguments{"--mcu", "native", "--seed", seed, "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return calibrate(arguments);
}

// 95 % of the absolute errors of the report's joints over their range, degrees.
double error_95(const json& report, std::uint64_t seed) {
  const auto params = sim::load_sensor_file("shared/robot/kaz/sensors.xml").value().potentiometer;
  std::vector<double> errors;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const auto& joint = report["joints"].at(static_cast<std::size_t>(j));
    const double centre = joint["centre_rad"], scale = joint["scale_rad"];
    const sim::Potentiometer pot(j, params, sim::SensorSwitches::as_built(), seed);
    for (int i = 0; i <= 40; ++i) {
      const double angle =
          1e-4 * (kz_board_joints[j].lower +
                  (kz_board_joints[j].upper - kz_board_joints[j].lower) * i / 40.0);
      const double code = 1024 * pot.ratio(angle) - 0.5;
      errors.push_back(std::abs(centre + scale * (code - 512) / 512 - angle) / kDegree);
    }
  }
  std::ranges::sort(errors);
  return errors[errors.size() * 95 / 100];
}

TEST(CalibrateJoints, OfAVirtualRobotAreStoredAndUsed) {
  const TemporaryFolder folder;
  const std::string memory = folder / "three.mem";
  const Finished done = run(on_native("3", {"--memory", memory, "--out", folder / "report"}));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(done.err.empty()) << done.err;
  const json report = parse_json(done.out);
  EXPECT_EQ(report["stored"], true);
  ASSERT_EQ(report["joints"].size(), 18u);
  EXPECT_GE(report["postures"].size(), 10u);
  EXPECT_LT(error_95(report, 3), 0.5);
  for (const auto& joint : report["joints"]) EXPECT_EQ(joint["good"], true) << joint.dump();
  EXPECT_EQ(parse_json(read_file(folder / "report/result.json"))["joints"], report["joints"]);
  EXPECT_NE(read_file(folder / "report/joints.svg").find("l_ankle_pitch"), std::string::npos);
  EXPECT_EQ(fs::file_size(memory), 3072u);

  // The stored values are those of the report, and a jig that agrees with them changes little.
  const Finished again =
      run(on_native("3", {"--memory", memory, "--gauge", "l_knee=0", "--no-store"}));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json gauged = parse_json(again.out);
  ASSERT_EQ(gauged["joints"].size(), 1u);
  EXPECT_EQ(gauged["joints"][0]["joint"], "l_knee");
  EXPECT_NEAR(gauged["joints"][0]["before"]["centre_rad"].get<double>(),
              report["joints"][12]["centre_rad"].get<double>(), 1e-9);
  EXPECT_NEAR(gauged["joints"][0]["centre_rad"].get<double>(),
              report["joints"][12]["centre_rad"].get<double>(), 0.4 * kDegree);
  EXPECT_EQ(gauged["stored"], false);

  const Finished ran =
      run(kaz({"run", "stand", "--mcu", "native", "--sensors", "as-built", "--seed", "3",
               "--memory", memory, "--set", "posture=straight", "--out", folder / "stand"}));
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  // The recording contains the memory: the file may be another one by then.
  fs::remove(memory);
  const Finished replayed = run(kaz({"replay", folder / "stand/recording.mcap", "--whole"}));
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;
}

// A joint that jams, and one whose potentiometer is worn: nothing is stored.
TEST(CalibrateJoints, AJointWithoutStopsIsNamedAndNothingIsStored) {
  const TemporaryFolder folder;
  write_file(folder / "jammed.txt", "at 0 s joint_stuck joint l_knee\n");
  const Finished jammed = run(on_native("4", {"--faults", folder / "jammed.txt"}));
  EXPECT_EQ(jammed.exit_code, 1) << jammed.err;
  EXPECT_NE(jammed.err.find("(l_knee)"), std::string::npos) << jammed.err;
  EXPECT_NE(jammed.err.find("nothing is stored"), std::string::npos) << jammed.err;

  write_file(folder / "faults.txt", "at 0 s pot_noisy joint l_elbow 5\n");
  const Finished done = run(on_native("4", {"--only", "stops", "--faults", folder / "faults.txt",
                                            "--memory", folder / "four.mem"}));
  EXPECT_EQ(done.exit_code, 1) << done.err;
  EXPECT_NE(done.err.find("no good reading of l_elbow; nothing is stored"), std::string::npos)
      << done.err;
  EXPECT_EQ(parse_json(done.out)["stored"], false);
  EXPECT_FALSE(fs::exists(folder / "four.mem"));
  // The floor alone needs what the stops have given.
  const Finished floor = run(on_native("4", {"--only", "floor"}));
  EXPECT_EQ(floor.exit_code, 1);
  EXPECT_NE(floor.err.find("--only stops"), std::string::npos) << floor.err;
}

// What a gauge says is stored if it can be so: not an angle that the potentiometer is far from.
TEST(CalibrateJoints, ByAGaugeWhatCannotBeSoIsNotStored) {
  const TemporaryFolder folder;
  const std::string memory = folder / "gauged.mem";
  const Finished wrong = run(on_native("3", {"--memory", memory, "--gauge", "l_knee=45"}));
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("no good reading of l_knee; nothing is stored"), std::string::npos)
      << wrong.err;
  const json report = parse_json(wrong.out);
  EXPECT_EQ(report["stored"], false);
  EXPECT_EQ(report["outcome"], "failed");
  EXPECT_EQ(report["joints"][0]["good"], false);
  EXPECT_NE(report["joints"][0]["fault"].get<std::string>().find("at the gauge angle 45.0 deg"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(memory));

  const Finished right = run(on_native("3", {"--memory", memory, "--gauge", "all=0"}));
  EXPECT_EQ(right.exit_code, 0) << right.err;
  const json stored = parse_json(right.out);
  EXPECT_EQ(stored["stored"], true);
  EXPECT_EQ(stored["outcome"], "done");
  for (const auto& joint : stored["joints"]) EXPECT_EQ(joint["good"], true) << joint.dump();
  EXPECT_TRUE(fs::exists(memory));
}

TEST(CalibrateJoints, OptionsAreChecked) {
  const TemporaryFolder folder;
  const Finished plan = run(calibrate({"--dry-run", "--robot", "serial:" + folder / "nobody"}));
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  for (const char* words :
       {"hangs by its trunk", "l_knee to 141", "r_sh_roll to 46", "level floor"})
    EXPECT_NE(plan.out.find(words), std::string::npos) << words << ": " << plan.out;
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"--gauge", "l_knee"}, "NAME=DEGREES"},
      {{"--gauge", "knee=3"}, "NAME=DEGREES"},
      {{"--gauge", "l_knee=170"}, "-5 to 140"},
      {{"--gauge", "l_knee=0", "--gauge", "all=0"}, "l_knee twice"},
      {{"--gauge", "l_knee=0", "--only", "floor"}, "--only floor"},
      {{"--robot", "serial:" + folder / "nobody", "--memory", "m"}, "--memory"},
      {{"--robot", "serial:" + folder / "nobody", "--seed", "4"}, "--seed"}};
  for (const auto& [options, words] : wrong) {
    const Finished refused = run(calibrate(options));
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
  }
}

// At a port nothing moves unless somebody says so; what is interrupted leaves no trace.
TEST(CalibrateJoints, AtAPortItPromptsAndLeavesTheBoardAsItWas) {
  const TemporaryFolder folder;
  const std::string board = folder / "board";
  Process sim(
      kaz({"sim", "--mcu", "native", "--serial", board, "--sensors", "as-built", "--suspended"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(20)));
  const std::vector<std::string> port{"--robot", "serial:" + board, "--only", "stops"};
  const Finished alone = run(calibrate(port));
  EXPECT_EQ(alone.exit_code, 2) << alone.err;
  EXPECT_NE(alone.err.find("--yes"), std::string::npos) << alone.err;

  Process prompted(calibrate(port), true);
  ASSERT_TRUE(prompted.wait_for_output("Press Enter to continue", seconds(20)));
  prompted.type("n\n");
  const Finished stopped = prompted.wait(seconds(20));
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("nothing is stored"), std::string::npos) << stopped.err;

  auto script = port;
  script.insert(script.end(), {"--yes", "--out", folder / "report"});
  Process running(calibrate(script));
  ASSERT_TRUE(running.wait_for_output("neck_pan", seconds(20)));
  running.signal(SIGTERM);
  const Finished ended = running.wait(seconds(20));
  EXPECT_EQ(ended.exit_code, 128 + SIGTERM) << ended.err;
  const json report = parse_json(read_file(folder / "report/result.json"));
  EXPECT_EQ(report["interrupted"], true);
  EXPECT_EQ(report["outcome"], "interrupted");
  EXPECT_EQ(report["stored"], false);

  // Nominal again, in RAM too, and motors off.
  const Finished after =
      run(calibrate({"--robot", "serial:" + board, "--gauge", "all=0", "--no-store", "--json"}));
  ASSERT_EQ(after.exit_code, 0) << after.err;
  const json nominal = parse_json(after.out);
  for (std::size_t j = 0; j < 18; ++j)
    EXPECT_NEAR(nominal["joints"][j]["before"]["scale_rad"].get<double>(),
                1e-4 * kz_board_joints[j].pot_scale, 1e-9);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(20)).exit_code, 0);
}

}  // namespace
}  // namespace kaz::test
