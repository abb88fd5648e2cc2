// A healthy motor passes; each limit of the group `motor` is broken by a motor, a potentiometer or a
// loop that is not as it should be.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "tests/integration/bench/motor_testing.h"

namespace kaz::hil {
namespace {

struct Breaker {
  const char* name;
  bool high;  // the limit that it breaks
  void (*spoil)(MotorTest& test);
};

void PrintTo(const Breaker& breaker, std::ostream* to) {
  *to << breaker.name << (breaker.high ? " above" : " below");
}

// Calibrates the joint's potentiometer wrongly.
void miscalibrate(MotorTest& test, double centre_rad, double scale) {
  test.prepare = [=](host::Robot& robot) {
    const auto now = robot.calibration();
    ASSERT_TRUE(now) << now.error().message;
    auto joints = now->joints;
    host::JointCalibration& joint = joints[host::l_sh_pitch];
    joint.centre_rad += centre_rad;
    joint.scale_rad *= scale;
    const auto set = robot.set_calibration(1u << host::l_sh_pitch, joints);
    ASSERT_TRUE(set) << set.error().message;
  };
}

const std::vector<Breaker>& breakers() {
  static const std::vector<Breaker> all = {
      {"direction", false, [](MotorTest& t) { t.inside = "at 0 s joint_reversed joint 2"; }},
      {"pot.noise", true,
       [](MotorTest& t) { t.board.sensor_params.potentiometer.noise_codes = 2; }},
      {"pot.linearity", true,
       [](MotorTest& t) {
         t.board.sensors = sim::SensorSet::as_built;
         // Largest deviation of any; each seed draws a share of it, 0.5 to 5 % of the range here.
         t.board.sensor_params.potentiometer.linearity = 0.2;
       }},
      {"pot.scale", true, [](MotorTest& t) { miscalibrate(t, 0, 1.04); }},
      {"pot.scale", false, [](MotorTest& t) { miscalibrate(t, 0, 0.96); }},
      {"pot.offset", true, [](MotorTest& t) { miscalibrate(t, 0.05, 1); }},
      {"pot.offset", false, [](MotorTest& t) { miscalibrate(t, -0.05, 1); }},
      {"backlash", true, [](MotorTest& t) { t.motor.backlash_rad = 0.7 * kDegree; }},
      {"backlash", false, [](MotorTest& t) { t.motor.backlash_rad = 0.01 * kDegree; }},
      {"dead_band", true, [](MotorTest& t) { t.motor.stiction_ratio = 2; }},
      {"dead_band", false, [](MotorTest& t) { t.motor.friction_nm = 0.05; }},
      {"friction.breakaway", true, [](MotorTest& t) { t.motor.stiction_ratio = 2; }},
      {"friction.breakaway", false, [](MotorTest& t) { t.motor.friction_nm = 0.05; }},
      {"friction.sliding", true, [](MotorTest& t) { t.motor.friction_nm = 0.21; }},
      {"friction.sliding", false, [](MotorTest& t) { t.motor.friction_nm = 0.05; }},
      {"friction.running", true, [](MotorTest& t) { t.motor.friction_nm = 0.21; }},
      {"friction.running", false, [](MotorTest& t) { t.motor.friction_nm = 0.05; }},
      {"no_load.speed", true, [](MotorTest& t) { t.motor.back_emf_nms_per_rad *= 0.8; }},
      {"no_load.speed", false, [](MotorTest& t) { t.motor.back_emf_nms_per_rad *= 1.25; }},
      {"no_load.slope", true, [](MotorTest& t) { t.motor.back_emf_nms_per_rad *= 0.8; }},
      {"no_load.slope", false, [](MotorTest& t) { t.motor.back_emf_nms_per_rad *= 1.25; }},
      {"start.time_constant", true, [](MotorTest& t) { t.motor.rotor_inertia_kgm2 = 1.5e-3; }},
      {"start.time_constant", false, [](MotorTest& t) { t.motor.rotor_inertia_kgm2 = 2e-5; }},
      {"stall.torque_4v8", true, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 1.06; }},
      {"stall.torque_4v8", false, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 0.94; }},
      {"stall.torque_10v", true, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 1.06; }},
      {"stall.torque_10v", false, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 0.94; }},
      {"stall.slope", true, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 1.15; }},
      {"stall.slope", false, [](MotorTest& t) { t.motor.stall_slope_nm_per_v *= 0.88; }},
      // A driver that gives no more than 8 V.
      {"stall.line_error", true, [](MotorTest& t) { t.motor.max_supply_v = 8; }},
      {"stall.asymmetry", true, [](MotorTest& t) { t.scale_forward = 1.06; }},
      {"stall.asymmetry", false, [](MotorTest& t) { t.scale_forward = 0.94; }},
      {"thermal.torque_loss", true, [](MotorTest& t) { t.motor.winding_heat_capacity *= 0.4; }},
      {"step.rise_time", true, [](MotorTest& t) { t.options.gains.kp_per_rad = 5; }},
      {"step.overshoot", true, [](MotorTest& t) { t.options.gains.kd_s_per_rad = 0; }},
      {"step.settling_time", true, [](MotorTest& t) { t.options.gains.kp_per_rad = 5; }},
      {"step.error", true, [](MotorTest& t) { t.options.gains.kp_per_rad = 2; }},
      // A worn gear.
      {"step.hunting", true, [](MotorTest& t) { t.motor.backlash_rad = 1.6 * kDegree; }},
      {"frequency.bandwidth", false, [](MotorTest& t) { t.options.gains.kp_per_rad = 5; }},
      {"frequency.phase_2hz", false, [](MotorTest& t) { t.options.gains.kp_per_rad = 5; }},
  };
  return all;
}

class MotorLimits : public testing::TestWithParam<Breaker> {};

// Whatever the seed of the noise.
TEST_P(MotorLimits, IsBroken) {
  const Breaker& breaker = GetParam();
  for (const std::uint64_t seed : {1, 2, 5}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    MotorTest test;
    test.board.seed = seed;
    // Friction values are as accurate as the torque line.
    test.options.filter = std::string(breaker.name).starts_with("friction") ||
                                  std::string(breaker.name) == "dead_band"
                              ? "friction|stall.slope|dead_band"
                              : "^" + std::string(breaker.name) + "$";
    breaker.spoil(test);
    const BenchReport report = measure_motor(test);
    const Measurement* found = nullptr;
    for (const Measurement& one : report.measurements) {
      if (one.of->name == breaker.name) found = &one;
    }
    ASSERT_NE(found, nullptr) << all_values(report);
    EXPECT_EQ(found->verdict, Verdict::failed) << all_values(report);
    if (breaker.high) {
      EXPECT_GT(found->value, found->high) << all_values(report);
    } else {
      EXPECT_LT(found->value, found->low) << all_values(report);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, MotorLimits, testing::ValuesIn(breakers()), [](const auto& one) {
  std::string name = one.param.name;
  std::ranges::replace(name, '.', '_');
  return name + (one.param.high ? "_above" : "_below");
});

TEST(MotorLimits, AreAllBroken) {
  for (const MeasurementInfo& info : measurement_infos()) {
    if (info.group != BenchGroup::motor) continue;
    for (const bool high : {false, true}) {
      if (std::isinf(high ? info.high : info.low)) continue;
      EXPECT_TRUE(std::ranges::any_of(breakers(),
                                      [&](const Breaker& breaker) {
                                        return info.name == breaker.name && breaker.high == high;
                                      }))
          << info.name << (high ? " above" : " below");
    }
  }
}

TEST(HealthyMotor, PassesOnJointsOfAllRangesAndSenses) {
  for (const int joint : {host::l_sh_pitch, host::neck_pan, host::r_hip_roll, host::l_hand}) {
    MotorTest test;
    test.options.joint = joint;
    const BenchReport report = measure_motor(test);
    EXPECT_EQ(names_with(report, Verdict::passed), names_of(BenchGroup::motor))
        << all_values(report);
    EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::motor).size());
  }
}

// A verdict does not depend on the seed of the noise: all measurements of one joint for each seed, and the
// step, the most sensitive of them, of more joints.
TEST(HealthyMotor, PassesUnderEachSeed) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const int joint = static_cast<int>(7 * seed % KZ_JOINTS);
    for (const int step :
         {-1, +host::l_sh_pitch, +host::r_elbow, +host::l_hand, +host::r_sh_pitch, +host::r_knee}) {
      MotorTest test;
      test.board.seed = seed;
      test.options.joint = step < 0 ? joint : step;
      if (step >= 0) test.options.filter = "^step";
      const BenchReport report = measure_motor(test);
      EXPECT_EQ(failed(report), Names{})
          << "seed " << seed << ", joint " << test.options.joint << "\n"
          << all_values(report);
      EXPECT_EQ(report.measurements.size(), step < 0 ? names_of(BenchGroup::motor).size() : 5u);
      EXPECT_LT(value(report, "step.settling_time"), 85) << "seed " << seed;
      EXPECT_LT(value(report, "step.hunting"), 20) << "seed " << seed;
    }
  }
}

// At the limit of `backlash` the loop may take all of the play, and still passes.
TEST(HealthyMotor, PassesWithAsMuchBacklashAsItMayHave) {
  MotorTest test;
  test.motor.backlash_rad = 0.59 * kDegree;
  test.options.filter = "backlash|step";
  const BenchReport report = measure_motor(test);
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  EXPECT_GT(value(report, "step.hunting"), 15);
}

// The paper's values (section 2.1), and the other motor parameters.
TEST(HealthyMotor, IsMeasuredAsItIs) {
  const BenchReport report = measure_motor({});
  const sim::MotorParams motor = kaz_motor();
  EXPECT_NEAR(value(report, "stall.torque_4v8"), 0.97, 0.01 * 0.97);
  EXPECT_NEAR(value(report, "stall.torque_10v"), 2.16, 0.01 * 2.16);
  EXPECT_NEAR(value(report, "stall.slope"), motor.stall_slope_nm_per_v,
              0.01 * motor.stall_slope_nm_per_v);
  EXPECT_NEAR(value(report, "friction.sliding"), motor.friction_nm, 0.05 * motor.friction_nm);
  // A motor that has pressed is some kelvin warmer: 3 %.
  EXPECT_NEAR(value(report, "friction.running"), motor.friction_nm, 0.05 * motor.friction_nm);
  EXPECT_NEAR(value(report, "friction.breakaway"), motor.friction_nm * motor.stiction_ratio,
              0.05 * motor.friction_nm * motor.stiction_ratio);
  EXPECT_NEAR(value(report, "backlash") * kDegree, motor.backlash_rad, 0.03 * motor.backlash_rad);
  const double speed =
      (motor.stall_slope_nm_per_v * 10 - motor.friction_nm) / motor.back_emf_nms_per_rad;
  EXPECT_NEAR(value(report, "no_load.speed"), speed, 0.01 * speed);
}

// The servo as sold, whose circuit gives its motor 6 V at most: the paper's other value.
TEST(HealthyMotor, OriginalCircuitHasThePapersTorqueAndNoMoreAbove) {
  MotorTest test;
  const auto original =
      sim::load_motor_file(std::string(KAZ_TREE) + "/shared/robot/kaz/motor.xml", "s9204-original");
  ASSERT_TRUE(original) << original.error().message;
  test.motor = *original;
  test.options.filter = "stall";
  const BenchReport report = measure_motor(test);
  EXPECT_NEAR(value(report, "stall.torque_4v8"), 0.97, 0.03 * 0.97) << all_values(report);
  EXPECT_TRUE(names_with(report, Verdict::passed).contains("stall.torque_4v8"));
  EXPECT_TRUE(failed(report).contains("stall.torque_10v"));
  EXPECT_TRUE(failed(report).contains("stall.line_error"));
}

TEST(HealthyMotor, IsTheSameEachTime) {
  MotorTest test;
  test.options.filter = "pot.noise|backlash|no_load";
  EXPECT_EQ(all_values(measure_motor(test)), all_values(measure_motor(test)));
}

TEST(MotorBench, WithoutAStandLeavesOutWhatNeedsOne) {
  MotorTest test;
  test.with_stand = false;
  const BenchReport report = measure_motor(test);
  EXPECT_EQ(names_with(report, Verdict::passed),
            (Names{"direction", "pot.noise", "dead_band", "no_load.speed", "no_load.slope",
                   "start.time_constant", "step.rise_time", "step.overshoot", "step.settling_time",
                   "step.error", "step.hunting", "frequency.bandwidth", "frequency.phase_2hz"}))
      << all_values(report);
  EXPECT_EQ(failed(report), Names{});
  EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::motor).size());
}

TEST(MotorBench, AMotorThatDoesNotTurnFailsAndTheRestGoesOn) {
  MotorTest test;
  test.motor.friction_nm = 3;
  const BenchReport report = measure_motor(test);
  EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::motor).size()) << all_values(report);
  for (const char* name : {"dead_band", "no_load.speed", "step.rise_time", "frequency.bandwidth",
                           "thermal.torque_loss"})
    EXPECT_TRUE(failed(report).contains(name)) << name << "\n" << all_values(report);
  EXPECT_TRUE(names_with(report, Verdict::passed).contains("pot.noise"));
  EXPECT_TRUE(names_with(report, Verdict::passed).contains("backlash")) << all_values(report);
}

// Each joint, also by a filter that does not take it, with a stand and without.
TEST(ReversedMotor, IsFoundBeforeAnyLoopIsClosed) {
  const std::uint64_t seeds[] = {1, 2, 5};
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    for (const char* filter : {"", "step|no_load", "dead_band"}) {
      MotorTest test;
      test.board.seed = seeds[joint % 3];
      test.options.joint = joint;
      test.options.filter = filter;
      test.with_stand = joint % 2 == 0;
      test.inside = "at 0 s joint_reversed joint " + std::to_string(joint);
      const BenchReport report = measure_motor(test);
      SCOPED_TRACE(std::to_string(joint) + " " + filter + "\n" + all_values(report));
      ASSERT_FALSE(report.measurements.empty());
      const Measurement& first = report.measurements.front();
      const std::string name = host::joint_table()[static_cast<std::size_t>(joint)].name;
      EXPECT_EQ(failed(report), Names{"direction"});
      EXPECT_EQ(first.of->name, "direction");
      EXPECT_EQ(first.message, name +
                                   " turns against its potentiometer: exchange the motor's two "
                                   "wires, or the two end wires of the potentiometer");
      EXPECT_EQ(report.count(Verdict::left_out), static_cast<int>(report.measurements.size()) - 1);
      for (std::size_t i = 1; i < report.measurements.size(); ++i)
        EXPECT_EQ(report.measurements[i].message,
                  "not run, because the measurement `direction` failed");
      EXPECT_LT(report.seconds, 6);
      EXPECT_TRUE(report.plots.empty());
    }
  }
}

TEST(ReversedMotor, IsNoneThatIsHealthy) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (int joint = 0; joint < KZ_JOINTS; ++joint) {
      for (const double backlash : {0.0, 0.4, 1.6}) {
        MotorTest test;
        test.board.seed = seed;
        test.options.joint = joint;
        test.options.filter = "direction";
        test.motor.backlash_rad = backlash * kDegree;
        const BenchReport report = measure_motor(test);
        EXPECT_EQ(names_with(report, Verdict::passed), Names{"direction"})
            << seed << " " << joint << " " << backlash << "\n"
            << all_values(report);
      }
    }
  }
}

// A filter whose parts drive no motor moves none.
TEST(ReversedMotor, IsNotLookedForWhereNothingIsDriven) {
  MotorTest test;
  test.inside = "at 0 s joint_reversed joint 2";
  for (const char* filter : {"^pot", "backlash"}) {
    test.options.filter = filter;
    EXPECT_EQ(failed(measure_motor(test)), Names{}) << filter;
  }
  test.with_stand = false;
  test.options.filter = "stall";
  EXPECT_EQ(failed(measure_motor(test)), Names{});
}

// Limits that another program has set on the board: the joint has its range, and them again afterwards.
TEST(MotorBench, MeasuresTheWholeRangeWhateverLimitsWereSet) {
  auto made = sim::make_stand(kaz_board(), {.motor = kaz_motor()});
  ASSERT_TRUE(made) << made.error().message;
  lockstep::StandBackend backend(std::move(*made));
  auto robot = host::Robot::connect(backend.link(), backend.clock(), bench_connection());
  ASSERT_TRUE(robot) << robot.error().message;
  MotorBenchOptions options;
  options.filter = "step|no_load";
  const auto joint = options.joint;
  ASSERT_TRUE(robot->set_limits(1u << joint,
                                {.ramp_rad_per_s = 3.3, .lower_rad = -0.1, .upper_rad = 0.12}));
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto ran = bench_motor(*robot, &backend.stand(), options, judge);
  ASSERT_TRUE(ran) << ran.error().message;
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  EXPECT_TRUE(names_with(report, Verdict::passed).contains("no_load.speed"));
  EXPECT_TRUE(names_with(report, Verdict::passed).contains("step.rise_time"));
  const auto after = robot->settings(joint);
  ASSERT_TRUE(after) << after.error().message;
  EXPECT_NEAR(after->limits.ramp_rad_per_s, 3.3, 0.01);
  EXPECT_NEAR(after->limits.lower_rad, -0.1, 1e-4);
  EXPECT_NEAR(after->limits.upper_rad, 0.12, 1e-4);
}

TEST(MotorBench, OtherLimitsAreThoseOfTheFile) {
  MotorTest test;
  test.options.filter = "backlash";
  test.limits["backlash"] = {0.1, 0.2};
  EXPECT_EQ(failed(measure_motor(test)), Names{"backlash"});
}

TEST(MotorBench, RefusesWhatItCannotMeasure) {
  auto made = sim::make_stand(kaz_board(), {.motor = kaz_motor()});
  ASSERT_TRUE(made);
  lockstep::StandBackend backend(std::move(*made));
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto error = [&](const MotorBenchOptions& options) {
    const auto ran = backend.run(options, judge);
    return ran ? std::string("done") : ran.error().message;
  };
  MotorBenchOptions options;
  options.filter = "(";
  EXPECT_NE(error(options).find("is not a regular expression"), std::string::npos);
  options.filter = "wings";
  EXPECT_EQ(
      error(options),
      "--filter wings matches no measurement of a motor; `kaz bench list` lists the measurements");
  options = {};
  options.joint = 18;
  EXPECT_EQ(error(options), "joint 18: must be 0 to 17");
}

}  // namespace
}  // namespace kaz::hil
