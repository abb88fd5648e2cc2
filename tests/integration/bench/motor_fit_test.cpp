// `bench fit` finds what was altered in a motor from what the bench has measured.
// SPDX-License-Identifier: Apache-2.0

#include "tests/integration/bench/motor_testing.h"
#include "tools/lockstep/motor_fit.h"

namespace kaz::hil {
namespace {

using lockstep::fit_motor;
using lockstep::MotorFit;
using lockstep::MotorFitOptions;

MotorFitOptions from_kaz() {
  MotorFitOptions options;
  options.start = kaz_motor();
  options.board = kaz_board();
  return options;
}

// The acceptance of the bench: friction, backlash, gain and dead band within 5 %; the rest as well.
void expect_recovered(const sim::MotorParams& motor) {
  MotorTest test;
  test.motor = motor;
  test.board.seed = 7;
  const BenchReport measured = measure_motor(test);
  MotorFitOptions options = from_kaz();
  double shown = 0;
  options.progress = [&](double share, const std::string&) { shown = share; };
  const auto fit = fit_motor(measured, options);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(shown, 1) << "the progress ends with the fit";
  const auto near = [&](const char* what, double found, double truth, double share = 0.05) {
    std::printf("%-16s %.5g, fitted %.5g: %+.1f %%\n", what, truth, found,
                100 * (found / truth - 1));
    EXPECT_NEAR(found, truth, share * truth) << what;
  };
  const sim::MotorParams& found = fit->motor;
  near("gain", found.stall_slope_nm_per_v, motor.stall_slope_nm_per_v);
  near("friction", found.friction_nm, motor.friction_nm);
  near("backlash", found.backlash_rad, motor.backlash_rad);
  near("dead band", found.friction_nm * found.stiction_ratio / found.stall_slope_nm_per_v,
       motor.friction_nm * motor.stiction_ratio / motor.stall_slope_nm_per_v);
  near("back-EMF", found.back_emf_nms_per_rad, motor.back_emf_nms_per_rad);
  // A start shows it together with the disc, of which it is the smaller part.
  near("rotor inertia", found.rotor_inertia_kgm2, motor.rotor_inertia_kgm2, 0.1);
  // By a loss of 8 % of a torque that is read within some 0.3 %.
  near("heat capacity", found.winding_heat_capacity, motor.winding_heat_capacity, 0.1);
  // The model is nearer to the motor in everything that was fitted, and in the curves.
  for (const lockstep::Gap& gap : fit->gaps) {
    if (gap.name == "curve of stall" || gap.name == "curve of no_load" ||
        gap.name == "curve of start") {
      EXPECT_LT(gap.after, 0.25 * gap.before) << gap.name;
    }
  }
}

TEST(MotorFit, FindsAWeakerMotorOfMoreFriction) {
  sim::MotorParams motor = kaz_motor();
  motor.stall_slope_nm_per_v *= 0.85;
  motor.friction_nm *= 1.3;
  motor.stiction_ratio = 1.15;
  motor.backlash_rad *= 0.7;
  motor.back_emf_nms_per_rad *= 1.2;
  motor.rotor_inertia_kgm2 *= 0.7;
  motor.winding_heat_capacity *= 1.3;
  expect_recovered(motor);
}

TEST(MotorFit, FindsAStrongerMotorOfMoreBacklash) {
  sim::MotorParams motor = kaz_motor();
  motor.stall_slope_nm_per_v *= 1.1;
  motor.friction_nm *= 0.75;
  motor.stiction_ratio = 1.6;
  motor.backlash_rad *= 1.3;
  motor.rotor_inertia_kgm2 *= 1.5;
  expect_recovered(motor);
}

TEST(MotorFit, LeavesWhatWasNotMeasured) {
  MotorTest test;
  test.options.filter = "stall|backlash";
  test.motor.stall_slope_nm_per_v *= 0.9;
  test.motor.friction_nm *= 1.4;
  MotorFitOptions options = from_kaz();
  options.max_rounds = 2;
  const auto fit = fit_motor(measure_motor(test), options);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->motor.stall_slope_nm_per_v, test.motor.stall_slope_nm_per_v, 0.005);
  EXPECT_NEAR(fit->motor.friction_nm, test.motor.friction_nm, 0.1 * test.motor.friction_nm)
      << "torques determine it roughly where no speeds were measured";
  EXPECT_EQ(fit->motor.rotor_inertia_kgm2, kaz_motor().rotor_inertia_kgm2);
  for (const lockstep::FittedParam& param : fit->params)
    EXPECT_EQ(param.measured,
              param.name == "stall_slope" || param.name == "friction" || param.name == "backlash")
        << param.name;
}

TEST(MotorFit, SaysWhyAReportIsOfNoUse) {
  const auto error = [](const BenchReport& report, const std::string& joint = {}) {
    MotorFitOptions options = from_kaz();
    options.joint = joint;
    const auto fit = fit_motor(report, options);
    return fit ? std::string("fitted") : fit.error().message;
  };
  EXPECT_EQ(error({}),
            "the report contains no measurements of a motor: give a report of `kaz bench motor`");
  MotorTest test;
  test.options.filter = "pot.noise";
  BenchReport report = measure_motor(test);
  EXPECT_EQ(error(report),
            "the report of l_sh_pitch determines no parameter of the motor: its measurements were "
            "skipped or failed");
  EXPECT_EQ(error(report, "l_knee"), "the report does not contain joint `l_knee`");
  BenchReport two = report;
  two.measurements.push_back(two.measurements.front());
  two.measurements.back().subject = "l_knee";
  EXPECT_EQ(error(two), "the report contains several joints; select one with --joint");
  report.conditions.clear();
  EXPECT_EQ(
      error(report),
      "the report lacks the disc's inertia or the supply voltage; a fit needs a report made with "
      "a motor stand (--stand)");
}

}  // namespace
}  // namespace kaz::hil
