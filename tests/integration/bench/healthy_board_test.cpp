// A healthy virtual board passes all measurements of link and tick, and no motor goes on.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "hil/bench/report.h"
#include "host/link/requester.h"
#include "host/link/stalling_testing.h"
#include "host/robot/connect.h"
#include "tests/integration/bench/measured_testing.h"
#include "tests/integration/bench/rewriting_link_testing.h"

namespace kaz::hil {
namespace {

std::unique_ptr<sim::Mcu> make_engine([[maybe_unused]] sim::McuKind mcu) {
#ifdef KAZ_FIRMWARE_IMAGE
  if (mcu == sim::McuKind::h8) {
    auto h8 = sim::make_h8(KAZ_FIRMWARE_IMAGE);
    EXPECT_TRUE(h8) << h8.error().message;
    return h8 ? std::move(*h8) : nullptr;
  }
#endif
  return sim::make_native();
}

class HealthyBoard : public ::testing::TestWithParam<sim::McuKind> {
 protected:
  lockstep::VirtualBench board_{make_engine(GetParam())};
};

TEST_P(HealthyBoard, PassesAllOfTheLink) {
  const BenchReport report = measure_link(board_, board_);
  EXPECT_EQ(names_with(report, Verdict::passed), names_of(BenchGroup::link)) << all_values(report);
  EXPECT_NEAR(value(report, "link.round_trip_median"), 6.8, 0.5) << "5.1 ms on the wire, 1 to 2.2";
  EXPECT_GT(value(report, "link.cycle_rate"), 120);
  EXPECT_EQ(value(report, "link.error_rate"), 0);
  EXPECT_EQ(value(report, "link.telemetry_loss"), 0);
  EXPECT_EQ(report.plots.size(), 2u);
}

TEST_P(HealthyBoard, PassesAllOfTheTick) {
  const BenchReport report = measure_tick(board_, board_);
  // The engine native has no timer that measures its ticks.
  Names due = names_of(BenchGroup::tick);
  if (GetParam() == sim::McuKind::native) {
    due.erase("tick.median");
    due.erase("tick.worst");
  }
  EXPECT_EQ(names_with(report, Verdict::passed), due) << all_values(report);
  EXPECT_EQ(failed(report), Names{});
  EXPECT_NEAR(value(report, "tick.clock_error"), 0, 1);
  EXPECT_EQ(report.plots.size(), GetParam() == sim::McuKind::native ? 1u : 2u);
}

TEST_P(HealthyBoard, PassesWithItsJointsOnAndHoldsThem) {
  LinkBenchOptions link;
  link.allow_motion = true;
  link.round_trips = 100;
  EXPECT_EQ(failed(measure_link(board_, board_, link)), Names{});
  TickBenchOptions tick;
  tick.allow_motion = true;
  const BenchReport report = measure_tick(board_, board_, tick);
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    EXPECT_NEAR(board_.angle_rad(joint), 0, 0.02);
    EXPECT_EQ(board_.drive(joint), 0) << "motors are off again";
  }
}

std::vector<sim::McuKind> engines() {
#ifdef KAZ_FIRMWARE_IMAGE
  return {sim::McuKind::native, sim::McuKind::h8};
#else
  return {sim::McuKind::native};
#endif
}
INSTANTIATE_TEST_SUITE_P(Engines, HealthyBoard, ::testing::ValuesIn(engines()),
                         [](const auto& tested) { return to_string(tested.param); });

// Every reply of the board carries its status.
TEST(BoardLine, NoMotorIsEverOnUnlessThatIsAllowed) {
  for (const bool allowed : {false, true}) {
    lockstep::VirtualBench board(sim::make_native());
    bool was_on = false;
    RewritingLink watched(board, [&](RewritingLink::Body& body) {
      constexpr std::size_t kStatusLow = KZ_HEADER_SIZE + 5;
      const bool identity = body[1] == KZ_TYPE_identify_reply;
      if (!identity) was_on = was_on || (body.at(kStatusLow) & KZ_STATUS_ENABLED);
    });
    LinkBenchOptions link;
    link.round_trips = 10;
    link.allow_motion = allowed;
    measure_link(watched, board, link);
    TickBenchOptions tick;
    tick.allow_motion = allowed;
    measure_tick(watched, board, tick);
    EXPECT_EQ(was_on, allowed);
  }
}

TEST(BoardLine, LeavesNoStreamBehindAndEndsThatOfOthers) {
  lockstep::VirtualBench board(sim::make_native());
  host::Requester before(board, board, {});
  const kz_telemetry all{10, KZ_TELEMETRY_COMMANDS};
  const host::Request request = host::make_request(KZ_TYPE_telemetry, all, kz_pack_telemetry);
  ASSERT_TRUE(before.exchange({&request, 1}));
  LinkBenchOptions options;
  options.round_trips = 20;
  EXPECT_EQ(failed(measure_link(board, board, options)), Names{});
  host::Requester after(board, board, {});
  const auto came = after.listen(board.now() + milliseconds(60));
  ASSERT_TRUE(came);
  EXPECT_FALSE(*came);
}

TEST(BoardLine, MotorsThatAreOnAreAnErrorAndStayOn) {
  lockstep::VirtualBench board(sim::make_native());
  auto robot = host::Robot::connect(board, board);
  ASSERT_TRUE(robot) << robot.error().message;
  ASSERT_TRUE(robot->enable(3));
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto measured = bench_link(board, board, {}, judge);
  ASSERT_FALSE(measured);
  EXPECT_EQ(measured.error().fault, Fault::environment);
  EXPECT_NE(measured.error().message.find("motors"), std::string::npos);
  EXPECT_TRUE(report.measurements.empty());
  const auto state = robot->state();
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->status & KZ_STATUS_ENABLED);
}

TEST(BoardLine, AnInterruptionLeavesTheMotorsOff) {
  lockstep::VirtualBench board(sim::make_native());
  // From the first cycle on nothing can be read, and the first `enable` is lost.
  struct Interrupted final : host::Link {
    explicit Interrupted(host::Link& other) : link(other) {}
    std::string name() const override { return link.name(); }
    Result<void> write(std::span<const std::uint8_t> bytes) override {
      constexpr std::size_t kType = 3;  // behind a zero, the stuffing byte and the address
      if (now && bytes[kType] == KZ_TYPE_enable && lost++ == 0) return {};
      return link.write(bytes);
    }
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
      if (now) return fail(Fault::environment, "interrupted");
      return link.read(bytes, deadline);
    }
    host::Link& link;
    bool now = false;
    int lost = 0;
  } link(board);
  bool was_on = false;
  RewritingLink watched(link, [&](RewritingLink::Body& body) {
    if (body[1] == KZ_TYPE_targets_reply) link.now = was_on = true;
  });
  LinkBenchOptions options;
  options.allow_motion = true;
  options.round_trips = 10;
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto measured = bench_link(watched, board, options, judge);
  ASSERT_FALSE(measured);
  EXPECT_EQ(measured.error().message, "interrupted");
  EXPECT_TRUE(was_on);
  // What was written last reaches the board, long before its link watchdog would have held it.
  ASSERT_TRUE(board.sleep_until(board.now() + milliseconds(40)));
  host::Requester after(board, board, {});
  const auto identity = host::identify_board(after);
  ASSERT_TRUE(identity) << identity.error().message;
  EXPECT_FALSE(identity->status & KZ_STATUS_ENABLED);
}

TEST(BoardLine, WithoutABoardThereIsASentence) {
  lockstep::VirtualBench board(sim::make_native());
  board.set_power(false);
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  for (const auto& measured :
       {bench_link(board, board, {}, judge), bench_tick(board, board, {}, judge)}) {
    ASSERT_FALSE(measured);
    EXPECT_EQ(measured.error().fault, Fault::environment);
    EXPECT_NE(measured.error().message.find("no board answers on virtual board"), std::string::npos)
        << measured.error().message;
  }
}

TEST(BoardLine, OnASharedLineWhatNeedsTelemetryIsLeftOut) {
  lockstep::VirtualBench board(sim::make_native());
  RewritingLink shared(
      board, change_of<kz_identify_reply>(KZ_TYPE_identify_reply, kz_unpack_identify_reply,
                                          kz_pack_identify_reply, [](kz_identify_reply& identity) {
                                            identity.capabilities &=
                                                static_cast<u16>(~KZ_CAPABILITY_TELEMETRY);
                                          }));
  EXPECT_EQ(names_with(measure_link(shared, board), Verdict::left_out),
            Names{"link.telemetry_loss"});
  EXPECT_EQ(names_with(measure_tick(shared, board), Verdict::left_out),
            (Names{"tick.median", "tick.jitter", "tick.clock_error"}));
}

TEST(BoardLine, AResetMeanwhileIsAnError) {
  lockstep::VirtualBench board(sim::make_native());
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  LinkBenchOptions link;
  link.progress = [&](double share, const std::string&) {
    if (share > 0.2 && share < 0.22) board.reset();
  };
  const auto measured = bench_link(board, board, link, judge);
  ASSERT_FALSE(measured);
  EXPECT_NE(measured.error().message.find("was reset"), std::string::npos);
}

// The board switches its motors off when the program is stopped for a while: with joints off the load is
// another one. It is run again, and the board is left as it was.
TEST(BoardLine, AStoppedProgramRunsItsLoadAgainAndLeavesNoShutdown) {
  for (const bool of_link : {true, false}) {
    lockstep::VirtualBench board(sim::make_native());
    host::StallingLine line(board, board);
    line.length = milliseconds(400);
    int loads = 0;
    double last = 1;
    const BenchProgress progress = [&](double share, const std::string& what) {
      if (what.find(of_link ? "control cycles" : "under load") == std::string::npos) return;
      if (share < last) ++loads;
      last = share;
      if (loads == 1 && share > (of_link ? 0.55 : 0.5)) line.stalls = 1;
      if (loads == 2) line.stalls = 0;
    };
    BenchReport report;
    const Limits none;
    BenchJudge judge(report, none);
    LinkBenchOptions link;
    link.allow_motion = true;
    link.round_trips = 20;
    link.progress = progress;
    TickBenchOptions tick;
    tick.allow_motion = true;
    tick.progress = progress;
    const auto measured =
        of_link ? bench_link(line, line, link, judge) : bench_tick(line, line, tick, judge);
    ASSERT_TRUE(measured) << measured.error().message;
    EXPECT_EQ(loads, 2) << of_link;
    host::Requester after(board, board, {});
    const auto identity = host::identify_board(after);
    ASSERT_TRUE(identity) << identity.error().message;
    EXPECT_EQ(identity->status >> 8, KZ_SHUTDOWN_NONE);
    EXPECT_FALSE(identity->status & KZ_STATUS_ENABLED);
  }
}

TEST(BoardLine, ProgressGoesFromNothingToAll) {
  lockstep::VirtualBench board(sim::make_native());
  double last = 0;
  const BenchProgress progress = [&](double share, const std::string& what) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1.0 + 1e-9);
    EXPECT_FALSE(what.empty());
    last = share;
  };
  LinkBenchOptions link;
  link.progress = progress;
  measure_link(board, board, link);
  EXPECT_NEAR(last, 1, 1e-9);
  last = 0;
  TickBenchOptions tick;
  tick.progress = progress;
  measure_tick(board, board, tick);
  EXPECT_NEAR(last, 1, 1e-9);
}

TEST(BoardLine, SameSeedSameReport) {
  const auto run = [] {
    lockstep::VirtualBench board(sim::make_native());
    LinkBenchOptions options;
    options.seed = 5;
    return bench_json(measure_link(board, board, options));
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace kaz::hil
