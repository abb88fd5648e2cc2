// What the bench says of a motor whose potentiometer is broken, or whose line is.
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <optional>
#include <string>

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
      board.sensors = sensors;
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
  EXPECT_NE(linearity->message.find("the reading changes by only "), std::string::npos);
}

// Quiet because the sensors are ideal, and healthy.
TEST(BrokenPotentiometer, IsNoneThatIsOnlyQuiet) {
  auto board = kaz_board();
  board.sensors = sim::SensorSet::ideal;
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
      EXPECT_EQ(one.doubt, Measurement::Doubt::line);
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

// Measurements one after the other on the same motor, the heat of the one before still in it.
struct Warmed {
  explicit Warmed(double slope = 1, double thermal = 1) {
    auto motor = kaz_motor();
    motor.stall_slope_nm_per_v *= slope;
    motor.winding_heat_capacity /= thermal;
    auto made = sim::make_stand(kaz_board(), {.motor = motor});
    EXPECT_TRUE(made) << made.error().message;
    backend.emplace(std::move(*made));
  }
  BenchReport bench(const std::string& filter) {
    BenchReport report;
    auto robot = host::Robot::connect(backend->link(), backend->clock(), bench_connection());
    EXPECT_TRUE(robot) << robot.error().message;
    MotorBenchOptions options;
    options.filter = filter;
    const Limits none;
    BenchJudge judge(report, none);
    const auto ran = bench_motor(*robot, &backend->stand(), options, judge);
    EXPECT_TRUE(ran) << ran.error().message;
    for (const Measurement& one : report.measurements) {
      if (one.verdict != Verdict::undecided) continue;
      EXPECT_EQ(one.doubt, Measurement::Doubt::motor);
      EXPECT_NE(one.message.find("the motor was warm: its torque grew by "), std::string::npos)
          << one.message;
    }
    return report;
  }
  void cool() {
    ASSERT_TRUE(backend->clock().sleep_until(backend->clock().now() + std::chrono::minutes(40)));
  }
  std::optional<lockstep::StandBackend> backend;
};

TEST(WarmMotor, AHealthyOneDoesNotFail) {
  Warmed motor;
  EXPECT_EQ(names_with(motor.bench("stall|thermal"), Verdict::undecided), Names{});
  bool undecided = false;
  for (int again = 0; again < 2; ++again) {
    for (const char* filter : {"thermal", "stall"}) {
      const BenchReport report = motor.bench(filter);
      EXPECT_EQ(failed(report), Names{}) << again << all_values(report);
      undecided = undecided || !names_with(report, Verdict::undecided).empty();
    }
  }
  EXPECT_TRUE(undecided);
  motor.cool();
  const BenchReport rested = motor.bench("stall|thermal");
  EXPECT_EQ(rested.count(Verdict::passed), 7) << all_values(rested);
}

// Too strong, as far as heat can hide: it fails, or is undecided, and never passes.
TEST(WarmMotor, OneThatIsTooStrongDoesNotPass) {
  for (const double slope : {1.05, 1.1}) {
    Warmed motor(slope);
    for (int again = 0; again < 2; ++again) {
      const BenchReport report = motor.bench("stall");
      const Names bad = failed(report), open = names_with(report, Verdict::undecided);
      EXPECT_TRUE(bad.contains("stall.torque_10v") || open.contains("stall.torque_10v"))
          << slope << " " << again << all_values(report);
      (void)motor.bench("thermal");
    }
    motor.cool();
    EXPECT_TRUE(failed(motor.bench("stall")).contains("stall.torque_10v")) << slope;
  }
}

// A winding that warms too much loses less where it is warm already.
TEST(WarmMotor, OneThatLosesTooMuchDoesNotPassWhenRepeated) {
  for (const double thermal : {1.9, 2.2}) {
    Warmed motor(1, thermal);
    EXPECT_TRUE(failed(motor.bench("thermal")).contains("thermal.torque_loss")) << thermal;
    for (int again = 0; again < 2; ++again) {
      const BenchReport report = motor.bench("thermal");
      EXPECT_EQ(names_with(report, Verdict::passed), Names{}) << thermal << all_values(report);
    }
  }
}

}  // namespace
}  // namespace kaz::hil
