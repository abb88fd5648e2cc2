// The motor measurements of an emulated board on the virtual stand.
// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/bench/motor_testing.h"

namespace kaz::hil {
namespace {

// A stand whose scale has a gain error in one direction.
class BentScale final : public Stand {
 public:
  BentScale(Stand& stand, double forward) : stand_(stand), forward_(forward) {}
  std::string name() const override { return stand_.name(); }
  Result<double> disc_kgm2() override { return stand_.disc_kgm2(); }
  Result<void> set_supply(double volts) override { return stand_.set_supply(volts); }
  Result<void> clamp(int joint, bool on) override { return stand_.clamp(joint, on); }
  Result<void> prepare_press(int joint, bool positive) override {
    return stand_.prepare_press(joint, positive);
  }
  Result<double> scale_nm(int joint) override {
    auto torque = stand_.scale_nm(joint);
    if (torque && *torque > 0) *torque *= forward_;
    return torque;
  }
  Result<void> press(int joint, double torque_nm) override {
    return stand_.press(joint, torque_nm);
  }
  Result<double> turn(int joint, double angle_rad) override {
    return stand_.turn(joint, angle_rad);
  }
  Result<void> let_go(int joint) override { return stand_.let_go(joint); }
  Result<void> put_back(double volts) override { return stand_.put_back(volts); }
  double pressing_s() const override { return stand_.pressing_s(); }
  double settling_s() const override { return stand_.settling_s(); }

 private:
  Stand& stand_;
  double forward_;
};

}  // namespace

BenchReport measure_motor(const MotorTest& test) {
  BenchReport report;
  auto made = sim::make_stand(
      test.board, {.motor = test.motor, .disc_kgm2 = test.disc_kgm2, .seed = test.board.seed});
  EXPECT_TRUE(made) << made.error().message;
  if (!made) return report;
  lockstep::StandBackend backend(std::move(*made));
  const auto faults = faults::Schedule::parse(test.inside, "the test");
  EXPECT_TRUE(faults) << faults.error().message;
  if (!faults) return report;
  for (const faults::Fault& fault : faults->faults()) backend.simulation().add_fault(fault);
  auto robot = host::Robot::connect(backend.link(), backend.clock(), bench_connection());
  EXPECT_TRUE(robot) << robot.error().message;
  if (!robot) return report;
  if (test.prepare) test.prepare(*robot);
  BentScale stand(backend.stand(), test.scale_forward);
  BenchJudge judge(report, test.limits);
  const Time begin = backend.clock().now();
  const auto ran = bench_motor(*robot, test.with_stand ? &stand : nullptr, test.options, judge);
  EXPECT_TRUE(ran) << ran.error().message;
  report.seconds = kaz::seconds(backend.clock().now() - begin);
  return report;
}

}  // namespace kaz::hil
