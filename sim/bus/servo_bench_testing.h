// For tests: one STS3215 with its motor model on a shaft with an inertia and a torque from outside.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/body/description/motor_file.h"
#include "sim/body/motor/joint_motor.h"
#include "sim/bus/virtual_servo.h"

namespace kaz::sim::test {

struct ServoBench {
  explicit ServoBench(const std::string& model = "sts3215", double inertia_kgm2 = 2e-3)
      : servo(*feetech::find_model(model), 1),
        motor(params(), kStep),
        inertia(inertia_kgm2),
        zero(servo.registers().model().steps / 2) {
    servo.set_power(false, reading());
    servo.set_power(true, reading());
  }
  static MotorParams params() {
    const auto read = load_motor_file("sim/robots/so101/motor.xml", "");
    EXPECT_TRUE(read) << read.error().message;
    return read ? *read : MotorParams{};
  }
  ServoReading reading() const {
    const double per_rad = servo.registers().model().steps_per_rad();
    return {zero + angle * per_rad, speed * per_rad, motor.motor_current(), motor.case_celsius(),
            volts};
  }
  // I (w1 - w0) / h = row + load, with w1 + softness * row = velocity within the row's bounds.
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / kStep); ++i) {
      time += std::chrono::milliseconds(1);
      const auto row = motor.prepare(servo.step(reading(), kStep, time), volts, angle, speed);
      const double yields = clamped ? 0 : kStep / inertia;
      const double free = clamped ? 0 : speed + yields * load_nm;
      const double torque =
          std::clamp((row.velocity - free) / (row.softness + yields), row.min, row.max);
      speed = free + yields * torque;
      angle += kStep * speed;
      motor.finish(speed, torque);
      fastest = std::max(fastest, std::abs(speed));
      highest = std::max(highest, get("present_position"));
    }
  }
  int get(const std::string& name) const { return servo.registers().get(name); }
  // As a host writes it, over the wire's packet.
  void set(const std::string& name, int value) {
    const auto& model = servo.registers().model();
    const auto& reg = *model.find(name);
    std::vector<std::uint8_t> parameters{reg.address};
    for (const auto byte : feetech::encode(model, reg, value)) parameters.push_back(byte);
    send(feetech::request(1, feetech::Instruction::write, parameters));
  }
  std::optional<VirtualServo::Answer> send(const feetech::Packet& packet) {
    std::optional<VirtualServo::Answer> answer;
    for (const auto byte : feetech::wire_of(packet)) answer = servo.take(byte, time);
    return answer;
  }
  double steps_per_rad() const { return servo.registers().model().steps_per_rad(); }

  static constexpr double kStep = 1e-3;
  VirtualServo servo;
  JointMotor motor;
  double inertia, zero;
  double angle = 0, speed = 0, load_nm = 0, volts = 7.4;
  bool clamped = false;  // a rigid clamp holds the shaft
  double fastest = 0;    // rad/s
  int highest = 0;       // present_position
  Time time{};
};

}  // namespace kaz::sim::test
