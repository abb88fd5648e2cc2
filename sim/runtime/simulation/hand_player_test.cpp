// What is done by hand moves the world as it says, is recorded, and done again it is the same run.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/hand_player.h"

#include <gtest/gtest.h>

#include <map>

#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

// Lines by the millisecond in which they are done.
class Script final : public HandSource {
 public:
  explicit Script(std::map<int, std::vector<std::string>> lines) : lines_(std::move(lines)) {}
  std::vector<std::string> take(Time start) override {
    const auto at = lines_.find(static_cast<int>(start / std::chrono::milliseconds(1)));
    return at == lines_.end() ? std::vector<std::string>() : at->second;
  }
  void refused(const std::string& line, const Error& error) override {
    refusals += line + ": " + error.message + "\n";
  }
  std::string refusals;

 private:
  std::map<int, std::vector<std::string>> lines_;
};

std::unique_ptr<Simulation> with_hands(HandSource* hands, const std::string& recording,
                                       Time detours = {}) {
  SimulationOptions options;
  options.world_path = KAZ_TREE "/sim/worlds/ball.sdf";
  options.robot_path = KAZ_TREE "/shared/robot/kaz/kaz.urdf";
  options.camera_path = KAZ_TREE "/shared/robot/kaz/camera.json";
  options.recording_path = recording;
  options.hands = hands;
  options.detour_every = detours;
  auto simulation = Simulation::create(options);
  EXPECT_TRUE(simulation) << simulation.error().message;
  return simulation ? std::move(*simulation) : nullptr;
}

void run(Simulation& simulation, int ms) {
  for (int i = 0; i < ms; ++i) ASSERT_TRUE(simulation.step());
}

Eigen::Vector3d ball(const Simulation& simulation) {
  return simulation.world().object_position("ball").value();
}

TEST(HandPlayer, AHeldBallIsCarriedAndFallsWhenItIsReleased) {
  const TestFolder folder;
  Script hands({{100, {"hold ball 0.3 0.2 0.2"}}, {1100, {"release ball"}}});
  const auto simulation = with_hands(&hands, folder.file("run.mcap"));
  run(*simulation, 1100);
  // The stiffness of the hand, and its weight carried: within a millimetre after a second.
  EXPECT_LT((ball(*simulation) - Eigen::Vector3d(0.3, 0.2, 0.2)).norm(), 1e-3);
  run(*simulation, 100);
  // Free fall: g t^2 / 2.
  EXPECT_NEAR(ball(*simulation).z(), 0.2 - 9.81 * 0.1 * 0.1 / 2, 2e-3);
  EXPECT_EQ(hands.refusals, "");
}

// Limp and on its feet, the robot gives way in proportion to the push, and in its direction.
TEST(HandPlayer, APushMovesTheRobotByItsImpulse) {
  const TestFolder folder;
  const auto moved = [&](const char* push) {
    Script hands({{100, {push}}});
    const auto simulation = with_hands(&hands, folder.file("run.mcap"));
    run(*simulation, 100);
    const Eigen::Vector3d before = simulation->world().link_pose("trunk").translation();
    run(*simulation, 20);
    EXPECT_EQ(hands.refusals, "");
    return Eigen::Vector3d(simulation->world().link_pose("trunk").translation() - before);
  };
  const Eigen::Vector3d none = moved("push trunk 0 0 0");
  const Eigen::Vector3d once = moved("push trunk 0.1 0 0") - none;
  const Eigen::Vector3d twice = moved("push trunk 0.2 0 0") - none;
  EXPECT_GT(once.x(), 3e-4);
  EXPECT_LT(std::abs(once.y()), 0.1 * once.x());
  EXPECT_NEAR(twice.x() / once.x(), 2, 0.5);
}

TEST(HandPlayer, WhatWasDoneIsRecordedAndDoneAgainTheRunIsTheSame) {
  const TestFolder folder;
  Script hands({{50, {"hold ball 0.3 0.2 0.1", "for 0.1 s pot_noisy joint 2 sigma 3 codes"}},
                {60, {"hold ball 0.3 0.25 0.1", "push trunk 0 0.1 0", "hold moon 0 0 0"}},
                {300, {"release ball", "clear"}}});
  const auto first = with_hands(&hands, folder.file("first.mcap"));
  run(*first, 400);
  const auto hash = first->finish_recording();
  EXPECT_NE(hands.refusals.find("hold moon 0 0 0: the world has no movable object `moon`"),
            std::string::npos);

  const auto recording = McapRecording::load(folder.file("first.mcap"));
  ASSERT_TRUE(recording);
  std::map<int, std::vector<std::string>> again;
  for (const auto& message : recording->messages) {
    if (recording->topics.at(message.channel) != "/hand") continue;
    LittleEndianFields fields(message.data);
    again[static_cast<int>(message.time_ns / 1'000'000)].push_back(fields.text());
  }
  ASSERT_EQ(again.size(), 3u);
  EXPECT_EQ(again[60].size(), 2u) << "what did nothing is not recorded";
  Script same(again);
  const auto second = with_hands(&same, folder.file("second.mcap"));
  run(*second, 400);
  EXPECT_EQ(*second->finish_recording(), *hash);

  // Saved, run on and restored in the middle of it.
  Script third_hands(again);
  const auto third =
      with_hands(&third_hands, folder.file("third.mcap"), std::chrono::milliseconds(70));
  run(*third, 400);
  EXPECT_EQ(*third->finish_recording(), *hash);
}

TEST(HandPlayer, LinesAreUnderstoodOrRefusedWithASentence) {
  for (const char* good : {"push trunk 0 0.1 -0.2", "hold ball 1 2 3", "release ball", "clear",
                           "power_reset", "for 1 s pot_open joint l_knee", "  link_cut to board  "})
    EXPECT_TRUE(parse_hand(good, Time::zero())) << good;
  for (const char* bad :
       {"", "push", "push trunk 1 2", "push trunk 1 2 6", "hold ball 1 2 nan", "hold ball 1 2 3 4",
        "hold ball 21 0 0", "release", "clear all", "at 1 s power_reset", "pot_open", "fly"}) {
    const auto act = parse_hand(bad, Time::zero());
    ASSERT_FALSE(act) << bad;
    EXPECT_NE(act.error().message.find("give `push LINK X Y Z`"), std::string::npos) << bad;
  }
  EXPECT_EQ(parse_hand("power_reset", std::chrono::seconds(3))->fault.at, std::chrono::seconds(3));
}

}  // namespace
}  // namespace kaz::sim
