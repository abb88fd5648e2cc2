// The host alone against its own recording: nothing differs; what differs is found where it is.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/replayed_board.h"

#include <gtest/gtest.h>

#include "host/robot/robot.h"
#include "sim/runtime/simulation/world_testing.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::lockstep {
namespace {

using std::chrono::milliseconds;

// A small behavior: moves the neck and looks at what its eyes see. `first_byte` sums what it saw.
struct Behavior {
  double target = 0.3;
  unsigned pairs = 0, first_byte = 0;

  Result<void> run(host::Link& link, host::Clock& clock, vision::Camera& camera) {
    auto robot = KAZ_TRY(host::Robot::connect(link, clock));
    if (auto on = robot.enable(1u << host::neck_pan); !on) return on;
    for (int i = 0; i < 20; ++i) {
      const host::JointTarget to{host::neck_pan, i < 10 ? 0.1 : target};
      if (auto set = robot.set_targets(std::span(&to, 1), milliseconds(50)); !set) return set;
      if (auto slept = clock.sleep_until(clock.now() + milliseconds(20)); !slept) return slept;
      KAZ_TRY(robot.state());
      while (true) {
        const auto pair = KAZ_TRY(camera.poll());
        if (!pair) break;
        ++pairs;
        first_byte += pair->images.get()->left.rgb[0];
      }
    }
    return {};
  }
};

struct Recorded {
  RecordedRun run;
  Behavior behavior;
};

Recorded record(const std::string& faults = "") {
  const sim::TestFolder folder;
  sim::SimulationOptions options;
  options.recording_path = folder.file("a.mcap");
  options.record_pictures = true;
  auto schedule = faults::Schedule::parse(faults, "test");
  EXPECT_TRUE(schedule);
  options.faults = *schedule;
  const auto simulation = sim::test_simulation(options);
  Recorded recorded;
  {
    LockstepClock clock(*simulation);
    LockstepLink link(*simulation);
    LockstepCamera camera(*simulation);
    const auto ran = recorded.behavior.run(link, clock, camera);
    EXPECT_TRUE(ran) << ran.error().message;
    simulation->record_behavior(R"({"phase":"end"})");
  }
  EXPECT_TRUE(simulation->finish_recording());
  const auto file = sim::McapRecording::load(options.recording_path);
  EXPECT_TRUE(file);
  auto run = RecordedRun::of(*file);
  EXPECT_TRUE(run) << run.error().message;
  recorded.run = std::move(*run);
  return recorded;
}

Result<void> replay(ReplayedBoard& board, Behavior& behavior) {
  ReplayClock clock(board);
  ReplayLink link(board);
  ReplayCamera camera(board);
  return behavior.run(link, clock, camera);
}

void expect_the_same(ReplayedBoard& board, Behavior& again) {
  const auto ran = replay(board, again);
  ASSERT_TRUE(ran) << ran.error().message;
  board.think(R"({"phase":"end"})");
  board.finish();
  EXPECT_FALSE(board.difference())
      << board.difference()->where << board.difference()->recorded << board.difference()->now;
}

TEST(ReplayedBoard, TheSameHostDoesTheSame) {
  const Recorded recorded = record();
  EXPECT_GT(recorded.run.to_board.size(), 500u);
  EXPECT_GT(recorded.behavior.pairs, 8u);
  ReplayedBoard board(recorded.run);
  Behavior again;
  expect_the_same(board, again);
  EXPECT_FALSE(board.other_thought());
  EXPECT_EQ(again.pairs, recorded.behavior.pairs);
  EXPECT_EQ(again.first_byte, recorded.behavior.first_byte);
}

// Bytes that the line lost, doubled or damaged reach both runs alike.
TEST(ReplayedBoard, FaultsOfTheLineHappenAgain) {
  const Recorded recorded = record("at 0.050 s for 1 s link_drop 0.01\n");
  ReplayedBoard board(recorded.run);
  Behavior again;
  expect_the_same(board, again);
}

TEST(ReplayedBoard, AnotherTargetIsFoundInItsMessage) {
  const Recorded recorded = record();
  ReplayedBoard board(recorded.run);
  Behavior other;
  other.target = 0.31;
  const auto ran = replay(board, other);
  ASSERT_FALSE(ran);
  EXPECT_EQ(ran.error().fault, Fault::failed);
  ASSERT_TRUE(board.difference());
  const HostDifference& found = *board.difference();
  EXPECT_GT(found.time, milliseconds(200));  // ten cycles of 20 ms are as they were
  EXPECT_EQ(found.where.find("byte "), 0u);
  EXPECT_NE(found.recorded.find("targets"), std::string::npos) << found.recorded;
  EXPECT_NE(found.now.find("targets"), std::string::npos) << found.now;
  EXPECT_NE(found.recorded, found.now);
}

TEST(ReplayedBoard, OneChangedByteIsFoundWhereItStands) {
  Recorded recorded = record();
  const std::size_t at = recorded.run.to_board.size() / 2;
  recorded.run.to_board[at].value ^= 0x10;
  ReplayedBoard board(recorded.run);
  Behavior same;
  EXPECT_FALSE(replay(board, same));
  ASSERT_TRUE(board.difference());
  EXPECT_EQ(board.difference()->where, "byte " + std::to_string(at) + " to the board");
  EXPECT_EQ(board.difference()->time, sim::time_of(recorded.run.to_board[at].at));
}

TEST(ReplayedBoard, AByteTooLateIsADifference) {
  Recorded recorded = record();
  recorded.run.to_board[100].at += 1;
  ReplayedBoard board(recorded.run);
  Behavior same;
  EXPECT_FALSE(replay(board, same));
  ASSERT_TRUE(board.difference());
  EXPECT_EQ(board.difference()->where, "byte 100 to the board");
}

TEST(ReplayedBoard, TheEndAndTheRecordOfTheBehaviorCount) {
  const Recorded recorded = record();
  {
    ReplayedBoard board(recorded.run);
    Behavior same;
    ASSERT_TRUE(replay(board, same));
    board.finish();
    ASSERT_TRUE(board.other_thought());
    EXPECT_EQ(board.other_thought()->now, "nothing");
    board.think("{}");
    EXPECT_NE(board.other_thought()->recorded.find("end"), std::string::npos);
  }
  ReplayedBoard board(recorded.run);
  board.finish();
  ASSERT_TRUE(board.difference());
  EXPECT_EQ(board.difference()->where, "byte 0 to the board");
  EXPECT_EQ(board.difference()->now, "nothing");
}

TEST(ReplayedBoard, APictureThatIsNoneEndsTheRun) {
  for (const bool other_size : {false, true}) {
    Recorded recorded = record();
    if (other_size) {
      recorded.run.camera.width += 1;
    } else {
      recorded.run.pairs.front().left_png = {1, 2, 3};
    }
    ReplayedBoard board(recorded.run);
    Behavior same;
    const auto ran = replay(board, same);
    ASSERT_FALSE(ran);
    EXPECT_EQ(ran.error().fault, Fault::usage);
    EXPECT_NE(ran.error().message.find("pair 1 of the recording: "), std::string::npos)
        << ran.error().message;
  }
}

// What was recorded up to some message, as after a crash.
RecordedRun cut_off(const RecordedRun& whole, double share) {
  RecordedRun run = whole;
  run.cut_off = true;
  run.thoughts.clear();
  run.end = static_cast<sim::States>(static_cast<double>(whole.end) * share) / KZ_STATES_PER_TICK *
            KZ_STATES_PER_TICK;
  std::erase_if(run.to_board, [&](const sim::SerialByte& byte) { return byte.at > run.end; });
  std::erase_if(run.to_host, [&](const sim::SerialByte& byte) { return byte.at > run.end; });
  return run;
}

TEST(ReplayedBoard, ARecordingThatWasCutOffIsComparedUpToItsEnd) {
  const Recorded recorded = record();
  const RecordedRun cut = cut_off(recorded.run, 0.6);
  {
    ReplayedBoard board(cut);
    Behavior same;
    const auto ran = replay(board, same);
    ASSERT_FALSE(ran) << "the recording ends before the host";
    EXPECT_NE(ran.error().message.find("the recording ends at "), std::string::npos);
    board.think("{}");  // what the host enters after that was not recorded
    board.finish();
    EXPECT_FALSE(board.difference());
    EXPECT_FALSE(board.other_thought());
  }
  ReplayedBoard board(cut);
  Behavior other;
  other.target = 0.31;  // from the tenth of 20 cycles on
  EXPECT_FALSE(replay(board, other));
  ASSERT_TRUE(board.difference());
  EXPECT_EQ(board.difference()->where.find("byte "), 0u);
}

TEST(ReplayedBoard, WithoutPicturesTheCameraSaysSo) {
  Recorded recorded = record();
  recorded.run.has_pictures = false;
  ReplayedBoard board(recorded.run);
  ReplayCamera camera(board);
  const auto pair = camera.poll();
  ASSERT_FALSE(pair);
  EXPECT_NE(pair.error().message.find("--record-pictures"), std::string::npos);
}

}  // namespace
}  // namespace kaz::lockstep
