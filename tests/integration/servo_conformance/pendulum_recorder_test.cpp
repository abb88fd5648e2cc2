// A pendulum on a virtual servo: recorded, fitted, and logs predicted that no fit has seen; limits, errors.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/pendulum_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "hil/servo/servo_fit.h"
#include "host/link/interruptible.h"
#include "shared/servo_model/servo_file.h"
#include "sim/bus/bus_testing.h"
#include "tests/integration/servo_conformance/bus_link_testing.h"

namespace kaz::test {
namespace {

std::unique_ptr<sim::VirtualBus> bench() {
  sim::WorldOptions options;
  options.hung = true;
  auto bus =
      sim::VirtualBus::load("sim/worlds/empty.sdf", "sim/robots/pendulum/pendulum.urdf", options);
  EXPECT_TRUE(bus) << bus.error().message;
  if (!bus) return nullptr;
  (*bus)->advance(std::chrono::milliseconds(3));
  return std::move(*bus);
}

hil::PendulumOptions weight() {
  hil::PendulumOptions options;
  options.mass_kg = 0.3;
  options.length_m = 0.15;
  options.arm_kg = 0.02;
  return options;
}

// Registers that a host writes, but for goals.
std::map<std::string, int> memory_of(const sim::VirtualBus& bus) {
  std::map<std::string, int> all;
  const auto& registers = bus.servo(0).registers();
  for (const auto& reg : registers.model().registers)
    if (reg.writable && reg.count == 1 && !reg.name.starts_with("goal_position") &&
        !reg.name.starts_with("goal_time"))
      all[std::string(reg.name)] = registers.get(reg);
  return all;
}

TEST(PendulumRecorder, ItsLogsAreFittedAndOthersPredicted) {
  const auto bus = bench();
  BusLink link(*bus);
  const auto before = memory_of(*bus);
  const auto record = hil::record_pendulum(link, link, weight());
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(memory_of(*bus), before);
  ASSERT_EQ(record->logs.size(), 12u);
  EXPECT_EQ(record->servo, "sts3215, id 1");
  std::vector<hil::ServoLog> fitted, held_out;
  for (const auto& one : record->logs) {
    EXPECT_EQ(one.missing, 0) << one.name;
    EXPECT_GT(one.log.samples.size(), 500u) << one.name;
    EXPECT_TRUE(one.log.has_current);
    EXPECT_TRUE(one.follows_profile);
    // What is written can be read.
    const auto again = hil::parse_servo_log(hil::servo_log_text(one.log), one.name);
    ASSERT_TRUE(again) << again.error().message;
    double reach = 0;
    for (const auto& sample : again->samples)
      reach = std::max(reach, std::abs(sample.position_rad));
    EXPECT_GT(reach, 0.3) << one.name;
    (one.held_out ? held_out : fitted).push_back(*again);
  }
  EXPECT_EQ(held_out.size(), 4u);
  hil::ServoFitOptions options;
  options.models = {1, 6};
  const auto fits = hil::fit_servo(fitted, held_out, options);
  ASSERT_TRUE(fits) << fits.error().message;
  const auto& fit = fits->back();
  RecordProperty("held_out_mrad", std::to_string(1000 * fit.held_out.position_rad));
  // The motor file has K = 1.297 Nm/A and 3.0 ohm, and names the identified servo.
  const auto servo = servo_model::shipped_servo("sts3215-12v")->params();
  EXPECT_LT(fit.held_out.position_rad, 0.003);
  EXPECT_LT(fit.held_out.current_share, 0.12);
  EXPECT_NEAR(fit.params.kt, 1.297, 0.05 * 1.297);
  // 7 % too high (3.25 ohm); the cause is not known. The winding is at 27.5 C, which adds 1 %.
  const double warm = bus->world().joints()[0].winding_celsius;
  const double resistance = 3 * (1 + 0.00393 * (warm - 25));
  EXPECT_NEAR(fit.params.resistance, resistance, 0.1 * resistance) << warm << " C";
  EXPECT_NEAR(fit.params.armature, servo.armature, 0.05 * servo.armature);
  // The logs do not determine the parameters of M6's friction one by one, nor the friction of a motor that
  // holds a falling weight back. Free, and when it lifts a weight:
  for (const double speed : {0.3, 1.0, 2.0})
    for (const auto& [motor, weight] : {std::pair{0.1, 0.0}, {0.4, -0.3}})
      EXPECT_NEAR(servo_model::friction_limit(6, fit.params, speed, motor, weight),
                  servo_model::friction_limit(6, servo, speed, motor, weight), 0.02)
          << speed << " rad/s, " << weight << " Nm";
  EXPECT_LT(fit.params.delay, 0.002)
      << "the recorded goal is the servo's setpoint, after the delay";
  // Another weight than stated is another servo: the fit is worse, or the motor another one.
  for (auto* logs : {&fitted, &held_out})
    for (auto& log : *logs) log.mass_kg *= 2;
  options.models = {1};
  const auto wrong = hil::fit_servo(fitted, held_out, options);
  ASSERT_TRUE(wrong);
  EXPECT_GT(std::abs(wrong->front().params.kt - 1.297), 0.2);
}

TEST(PendulumRecorder, ALimitAnErrorOrAnInterruptSwitchesTheTorqueOff) {
  const auto refused = [](hil::PendulumOptions options,
                          const std::function<void(BusLink&, sim::VirtualBus&)>& alter) {
    const auto bus = bench();
    BusLink link(*bus);
    const auto before = memory_of(*bus);
    alter(link, *bus);
    const auto record = hil::record_pendulum(link, link, options);
    EXPECT_FALSE(record);
    EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);
    auto after = memory_of(*bus);
    EXPECT_EQ(after, before);
    return record ? "" : record.error().message;
  };
  const auto nothing = [](BusLink&, sim::VirtualBus&) {};
  auto weak = weight();
  weak.max_amps = 0.1;
  EXPECT_NE(refused(weak, nothing).find("; use a lighter weight"), std::string::npos);
  auto cool = weight();
  cool.max_celsius = 20;
  EXPECT_NE(refused(cool, nothing).find("let the servo cool"), std::string::npos);
  auto wide = weight();
  wide.amplitude_rad = 3;
  EXPECT_NE(refused(wide, nothing).find("put the horn on"), std::string::npos);
  EXPECT_NE(refused(weight(), [](BusLink&, sim::VirtualBus& bus) { bus.set_supply_volts(3.5); })
                .find("reports an error"),
            std::string::npos);
  auto other = weight();
  other.id = 7;
  EXPECT_NE(refused(other, nothing).find("does not answer"), std::string::npos);
}

TEST(PendulumRecorder, ATorqueThatStaysOnEndsItAndIsNamed) {
  const auto bus = bench();
  BusLink link(*bus);
  link.request = [](BusLink::Bytes wire) { return switches_off(wire) ? BusLink::Bytes() : wire; };
  auto options = weight();
  options.seconds = 1.5;
  const auto record = hil::record_pendulum(link, link, options);
  ASSERT_FALSE(record);
  EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 1);
  EXPECT_NE(
      record.error().message.find("may still hold the arm, because its torque is not confirmed to "
                                  "be off: cut its power; and servo 1 on bus was left in a changed "
                                  "state: its torque is not confirmed to be off: cut its power"),
      std::string::npos)
      << record.error().message;
}

TEST(PendulumRecorder, AnInterruptOnTheWayLeavesTheServoAsItWas) {
  for (const int at : {100, 1500, 4000}) {
    const auto bus = bench();
    BusLink link(*bus);
    const auto before = memory_of(*bus);
    host::Interrupt interrupt;
    host::InterruptibleLink broken(link, link, interrupt);
    host::InterruptibleClock clock(link, interrupt);
    link.request = [&, requests = 0](BusLink::Bytes wire) mutable {
      if (++requests == at) interrupt.request();
      return wire;
    };
    auto options = weight();
    options.interrupt = &interrupt;
    const auto record = hil::record_pendulum(broken, clock, options);
    ASSERT_FALSE(record);
    EXPECT_EQ(record.error().fault, Fault::interrupted) << record.error().message;
    EXPECT_EQ(memory_of(*bus), before) << at;
    EXPECT_EQ(bus->servo(0).registers().get("torque_enable"), 0);
  }
}

// A servo without weight and friction: what matters is that the other protocol has the same logs.
TEST(PendulumRecorder, DynamixelsHaveTheirOwnLaw) {
  const auto bus = sim::test::bus_of({1}, "xl330-m288");
  bus->advance(std::chrono::milliseconds(3));
  BusLink link(*bus);
  const auto before = memory_of(*bus);
  auto options = weight();
  options.protocol = servo_bus::Protocol::dynamixel;
  const auto record = hil::record_pendulum(link, link, options);
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(memory_of(*bus), before);
  EXPECT_EQ(record->servo, "xl330-m288, id 1");
  // docs/howto/bench.md: 1.15 at P = 400.
  EXPECT_NEAR(record->logs[4].log.gain_per_rad, 1.15, 0.01);
  EXPECT_TRUE(record->logs[4].held_out);
  const auto scs = sim::test::bus_of({1}, "scs0009");
  scs->advance(std::chrono::milliseconds(3));
  BusLink other(*scs);
  const auto unknown = hil::record_pendulum(other, other, weight());
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("is not published"), std::string::npos);
}

}  // namespace
}  // namespace kaz::test
