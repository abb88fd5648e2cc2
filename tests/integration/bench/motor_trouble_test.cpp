// What the bench says of a motor whose potentiometer is broken, or whose line is.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/faulty_link.h"
#include "tests/integration/bench/motor_testing.h"

namespace kaz::hil {
namespace {

struct Benched {
  Result<void> ran;
  BenchReport report;
};

faults::Schedule schedule_of(const std::string& text) {
  auto schedule = faults::Schedule::parse(text, "the test");
  EXPECT_TRUE(schedule) << schedule.error().message;
  return schedule.value_or(faults::Schedule{});
}

// `inside`: faults of the simulated joint; `on_line`: of the line, their times from when the bench begins.
// `stopped`: an emergency stop of before is latched.
Benched bench_with(const std::string& inside, const std::string& on_line, const std::string& filter,
                   sim::SimulationOptions board = kaz_board(), std::uint64_t seed = 1,
                   bool stopped = false) {
  Benched benched;
  auto made = sim::make_stand(board, {.motor = kaz_motor()});
  EXPECT_TRUE(made) << made.error().message;
  if (!made) return benched;
  lockstep::StandBackend backend(std::move(*made));
  const faults::Schedule faults = schedule_of(inside);
  for (const faults::Fault& fault : faults.faults()) backend.simulation().add_fault(fault);
  host::FaultyLink line(backend.link(), backend.clock(), schedule_of(on_line), seed);
  auto robot = host::Robot::connect(line, backend.clock(), bench_connection());
  EXPECT_TRUE(robot) << robot.error().message;
  if (!robot) return benched;
  if (stopped) {
    EXPECT_TRUE(robot->stop());
  }
  MotorBenchOptions options;
  options.filter = filter;
  const Limits none;
  BenchJudge judge(benched.report, none);
  benched.ran = bench_motor(*robot, &backend.stand(), options, judge);
  return benched;
}

const Measurement* find(const BenchReport& report, const std::string& name) {
  for (const Measurement& one : report.measurements)
    if (one.of->name == name) return &one;
  return nullptr;
}

// The board keeps the last angle then: a reading within the limits, without any noise.
TEST(BrokenPotentiometer, WithoutAReadingIsNotQuiet) {
  for (const char* fault :
       {"pot_open joint 2", "pot_short joint 2", "pot_open joint 2 0", "pot_short joint 2 1"}) {
    for (const auto sensors : {sim::SensorSet::nominal, sim::SensorSet::ideal}) {
      auto board = kaz_board();
      board.sensors = sim::sensor_switches(sensors);
      const Benched benched = bench_with("at 0 s " + std::string(fault), "", "^pot", board);
      ASSERT_TRUE(benched.ran) << benched.ran.error().message;
      EXPECT_EQ(failed(benched.report),
                (Names{"pot.noise", "pot.linearity", "pot.scale", "pot.offset"}))
          << fault << "\n"
          << all_values(benched.report);
      const Measurement* noise = find(benched.report, "pot.noise");
      ASSERT_NE(noise, nullptr);
      EXPECT_NE(noise->message.find("wiper is open or touches a supply"), std::string::npos)
          << noise->message;
    }
  }
}

TEST(BrokenPotentiometer, AlsoWhereItBreaksMeanwhile) {
  const Benched benched = bench_with("at 1.2 s pot_short joint 2", "", "^pot.noise");
  EXPECT_EQ(failed(benched.report), Names{"pot.noise"}) << all_values(benched.report);
}

// A reading that stays where it is has no line to judge.
TEST(BrokenPotentiometer, ThatDoesNotFollowHasNoLine) {
  const Benched benched = bench_with("at 0 s pot_stuck joint 2", "", "^pot");
  ASSERT_TRUE(benched.ran) << benched.ran.error().message;
  EXPECT_EQ(failed(benched.report), (Names{"pot.linearity", "pot.scale", "pot.offset"}))
      << all_values(benched.report);
  const Measurement* linearity = find(benched.report, "pot.linearity");
  ASSERT_TRUE(linearity);
  EXPECT_NE(linearity->message.find("follows the shaft by "), std::string::npos);
}

// Quiet because the sensors are ideal, and healthy.
TEST(BrokenPotentiometer, IsNoneThatIsOnlyQuiet) {
  auto board = kaz_board();
  board.sensors = sim::sensor_switches(sim::SensorSet::ideal);
  const Benched benched = bench_with("", "", "^pot.noise", board);
  EXPECT_EQ(failed(benched.report), Names{}) << all_values(benched.report);
}

TEST(DisturbedLine, ForAWhileIsMeasuredAgain) {
  const Benched benched = bench_with("", "at 6 s for 0.8 s link_cut", "pot|backlash|step");
  ASSERT_TRUE(benched.ran) << benched.ran.error().message;
  EXPECT_EQ(failed(benched.report), Names{}) << all_values(benched.report);
  EXPECT_EQ(names_with(benched.report, Verdict::undecided), Names{}) << all_values(benched.report);
}

TEST(DisturbedLine, IsNoFailureOfTheMotor) {
  bool undecided = false;
  for (const char* fault : {"link_flip 0.003", "link_drop 0.003", "link_drop 0.01 to board"}) {
    const Benched benched =
        bench_with("", "at 0.5 s " + std::string(fault), "pot|backlash|no_load|step|frequency");
    EXPECT_EQ(failed(benched.report), Names{}) << fault << "\n" << all_values(benched.report);
    for (const Measurement& one : benched.report.measurements) {
      if (one.verdict != Verdict::undecided) continue;
      undecided = true;
      EXPECT_TRUE(one.disturbed);
      EXPECT_NE(one.message.find("; but on the line "), std::string::npos) << one.message;
    }
  }
  EXPECT_TRUE(undecided);
}

// Whenever it is: what broke off is no failure either.
TEST(DisturbedLine, OneThatIsCutForGoodEndsTheBench) {
  for (int tenths = 5; tenths < 400; tenths += 26) {
    const std::string cut = "at " + std::to_string(0.1 * tenths) + " s link_cut";
    const Benched benched = bench_with("", cut, "pot|backlash|step");
    ASSERT_FALSE(benched.ran) << cut;
    EXPECT_EQ(benched.ran.error().fault, Fault::environment) << benched.ran.error().message;
    EXPECT_EQ(failed(benched.report), Names{}) << cut << "\n" << all_values(benched.report);
  }
}

// A motor that is wrong stays so on a line that is not disturbed.
TEST(DisturbedLine, ExcusesNoMotorOnAHealthyOne) {
  const Benched benched = bench_with("at 0 s joint_stuck joint 2", "", "no_load");
  EXPECT_TRUE(failed(benched.report).contains("no_load.speed")) << all_values(benched.report);
}

// A shutdown that is older than the bench is none of the motor's.
TEST(LatchedShutdown, OfBeforeIsCleared) {
  const Benched benched = bench_with("", "", "^pot|backlash", kaz_board(), 1, true);
  ASSERT_TRUE(benched.ran) << benched.ran.error().message;
  EXPECT_EQ(failed(benched.report), Names{}) << all_values(benched.report);
}

// One after the other on the same motor, the heat of the one before still in it: a healthy motor does not
// fail, and one that rests passes again.
TEST(WarmMotor, IsNoWeakOne) {
  auto made = sim::make_stand(kaz_board(), {.motor = kaz_motor()});
  ASSERT_TRUE(made) << made.error().message;
  lockstep::StandBackend backend(std::move(*made));
  bool undecided = false;
  const auto bench = [&](const std::string& filter) {
    BenchReport report;
    auto robot = host::Robot::connect(backend.link(), backend.clock(), bench_connection());
    ASSERT_TRUE(robot) << robot.error().message;
    MotorBenchOptions options;
    options.filter = filter;
    const Limits none;
    BenchJudge judge(report, none);
    const auto ran = bench_motor(*robot, &backend.stand(), options, judge);
    ASSERT_TRUE(ran) << ran.error().message;
    EXPECT_EQ(failed(report), Names{}) << all_values(report);
    const Names doubtful = names_with(report, Verdict::undecided);
    undecided = !doubtful.empty();
    for (const Measurement& one : report.measurements) {
      if (one.verdict != Verdict::undecided) continue;
      EXPECT_NE(one.message.find("the motor was warm: at rest its torque grew by "),
                std::string::npos)
          << one.message;
    }
  };
  bench("stall");
  EXPECT_FALSE(undecided) << "a cold motor passes";
  bench("thermal");
  for (int again = 0; again < 3; ++again) {
    bench("stall");
    EXPECT_TRUE(undecided) << again;
  }
  ASSERT_TRUE(backend.clock().sleep_until(backend.clock().now() + std::chrono::minutes(40)));
  bench("stall");
  EXPECT_FALSE(undecided) << "cold again";
}

}  // namespace
}  // namespace kaz::hil
