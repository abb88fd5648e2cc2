// Ranges that wrap, that fit, and that no register helps.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/joint_range.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kaz::host {
namespace {

constexpr double kLower = -1.2, kUpper = 1.6;  // 160 degrees, not about 0

servo_bus::BusServo servo_of(const char* model, bool reversed = false) {
  const auto* found = servo_bus::find_model(model);
  return {"joint", 1, found, found->steps / 2.0, reversed};
}

// A servo whose encoder is at `zero` steps at the joint's angle 0, swept over its range by hand.
class Swept {
 public:
  Swept(const servo_bus::BusServo& servo, double zero, RangeRegisters registers)
      : servo_(servo), zero_(zero), registers_(registers) {}
  // As the servo itself has it, with these registers.
  double position(double angle, const RangeRegisters& with) const {
    const auto& model = *servo_.model;
    const double encoder = std::round(zero_ + servo_.sign() * angle * model.steps_per_rad());
    if (model.protocol == servo_bus::Protocol::dynamixel) return encoder + with.offset;
    if (!model.full_turn) return std::clamp(encoder, 0.0, model.steps - 1.0);
    const double position = std::fmod(encoder - with.offset, model.steps);
    return position < 0 ? position + model.steps : position;
  }
  RangeSweep sweep(double lower = kLower, double upper = kUpper, double step = 0.02) const {
    RangeSweep sweep(*servo_.model);
    const double begin = (lower + upper) / 3;
    for (double a = begin; a < upper; a += step) sweep.add(position(a, registers_));
    sweep.add(position(upper, registers_));
    for (double a = upper; a > lower; a -= step) sweep.add(position(a, registers_));
    sweep.add(position(lower, registers_));
    return sweep;
  }
  RangePlan plan() const { return plan_range(servo_, kLower, kUpper, registers_, sweep()); }

  // Nowhere in the range a jump, all goals allowed, and angles as they are.
  void expect_good(const RangePlan& plan) const {
    ASSERT_EQ(plan.fault, "");
    servo_bus::BusServo calibrated = servo_;
    calibrated.zero = plan.zero;
    // A DYNAMIXEL forgets its turns when the torque comes.
    const double turns =
        servo_.model->protocol == servo_bus::Protocol::dynamixel
            ? servo_.model->steps *
                  std::floor((position(kLower, plan.registers) - plan.registers.offset) /
                             servo_.model->steps)
            : 0;
    for (double angle = kLower; angle <= kUpper; angle += 0.01) {
      const double now = position(angle, plan.registers) - turns;
      ASSERT_GE(now, 0);
      ASSERT_LT(now, servo_.model->steps);
      ASSERT_NEAR(calibrated.angle_at(now), angle, 3 / servo_.model->steps_per_rad()) << angle;
      if (plan.registers.high != 0) {
        ASSERT_GE(now, plan.registers.low);
        ASSERT_LE(now, plan.registers.high);
      }
    }
  }

 private:
  servo_bus::BusServo servo_;
  double zero_;
  RangeRegisters registers_;
};

TEST(JointRange, AnStsIsFreeOfTheWrapWhereverItsHornSits) {
  for (const bool reversed : {false, true}) {
    for (const int offset : {0, -2047, -500, 1234, 2047}) {
      for (int zero = 0; zero < 4096; zero += 64) {
        const Swept swept(servo_of("sts3215", reversed), zero, {offset, 0, 4095, false});
        SCOPED_TRACE(std::to_string(zero) + " " + std::to_string(offset));
        const RangePlan plan = swept.plan();
        swept.expect_good(plan);
        EXPECT_LE(std::abs(plan.registers.offset), 2047);
        // What fits is left alone.
        const double low = swept.position(reversed ? kUpper : kLower, {offset, 0, 0, false}),
                     high = low + (kUpper - kLower) * 4096 / (2 * M_PI);
        if (low > kRangeMargin + 2 && high < 4093 - kRangeMargin) {
          EXPECT_EQ(plan.registers, (RangeRegisters{offset, 0, 4095, false}));
        }
        if (high > 4096) {
          EXPECT_TRUE(plan.wrapped);
        }
      }
    }
  }
}

TEST(JointRange, LimitsThatCutTheRangeOffAreMoved) {
  const Swept swept(servo_of("sts3215"), 2048, {0, 1800, 2500, false});
  const auto plan = swept.plan();
  swept.expect_good(plan);
  EXPECT_EQ(plan.registers.offset, 0);
  EXPECT_LT(plan.registers.low, 1300);
  // Both 0: none, which stays.
  const auto none = Swept(servo_of("sts3215"), 10, {0, 0, 0, false}).plan();
  EXPECT_EQ(none.fault, "");
  EXPECT_NE(none.registers.offset, 0);
  EXPECT_EQ(none.registers.high, 0);
}

TEST(JointRange, ADynamixelThatWrapsHasToBeMountedAnew) {
  int faults = 0, good = 0;
  for (int zero = 0; zero < 3 * 4096; zero += 64) {
    const Swept swept(servo_of("xl330-m288"), zero, {0, 0, 4095, false});
    const auto plan = swept.plan();
    if (plan.fault.empty()) {
      ++good;
      swept.expect_good(plan);
    } else {
      ++faults;
      EXPECT_TRUE(plan.wrapped);
      EXPECT_NE(plan.fault.find("take the horn off"), std::string::npos);
    }
  }
  EXPECT_NEAR(faults / 192.0, (kUpper - kLower) / (2 * M_PI), 0.02);
  EXPECT_GT(good, 0);
  // An offset that moves the range out of the turn is taken back.
  const Swept shifted(servo_of("xl330-m288"), 1000, {-900, 0, 4095, false});
  const auto plan = shifted.plan();
  shifted.expect_good(plan);
  EXPECT_EQ(plan.registers.offset, 0);
}

TEST(JointRange, AnScsEndsWithItsSensor) {
  const Swept swept(servo_of("scs0009"), 500, {0, 20, 1003, false});
  swept.expect_good(swept.plan());
  const auto beyond = Swept(servo_of("scs0009"), 900, {0, 20, 1003, false}).plan();
  EXPECT_NE(beyond.fault, "");
}

TEST(JointRange, SweepsThatProveNothingAreFaults) {
  const auto servo = servo_of("sts3215");
  const Swept swept(servo, 2048, {0, 0, 4095, false});
  const auto fault = [&](const RangeSweep& sweep,
                         const RangeRegisters& with = {0, 0, 4095, false}) {
    return plan_range(servo, kLower, kUpper, with, sweep).fault;
  };
  EXPECT_NE(fault(RangeSweep(*servo.model)).find("not read"), std::string::npos);
  EXPECT_NE(fault(swept.sweep(-0.5, 0.5)).find("from one stop to the other"), std::string::npos);
  EXPECT_NE(fault(swept.sweep(-2, 2.5)).find("from one stop to the other"), std::string::npos);
  EXPECT_NE(fault(swept.sweep(kLower, kUpper, 1.7)).find("turn the joint slowly"),
            std::string::npos);
  EXPECT_NE(fault(swept.sweep(), {0, 0, 4095, true}).find("counts turns"), std::string::npos);
}

TEST(JointRange, AWholeTurnHasNoPlace) {
  const auto servo = servo_of("sts3215");
  RangeSweep sweep(*servo.model);
  for (int p = 0; p < 4090; p += 10) sweep.add(p);
  const auto plan = plan_range(servo, -3.13, 3.13, {0, 0, 4095, false}, sweep);
  EXPECT_NE(plan.fault.find("smaller than one full turn"), std::string::npos) << plan.fault;
}

}  // namespace
}  // namespace kaz::host
