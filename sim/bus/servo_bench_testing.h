// For tests: one servo with its motor model, on a shaft with an inertia and an external torque.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/body/description/motor_file.h"
#include "sim/body/motor/joint_motor.h"
#include "sim/bus/bus_testing.h"

namespace kaz::sim::test {

struct ServoBench {
  explicit ServoBench(const std::string& model = "sts3215", double inertia_kgm2 = 2e-3)
      : ServoBench(*servo_bus::find_model(model), inertia_kgm2) {}
  explicit ServoBench(const servo_bus::Model& model, double inertia_kgm2)
      : servo(VirtualServo::make(model, 1)),
        motor(params(model), kStep),
        inertia(inertia_kgm2),
        zero(model.steps / 2),
        volts(model.protocol == servo_bus::Protocol::feetech ? 7.4 : 5) {
    power_cycle();
  }
  static MotorParams params(const servo_bus::Model& model) {
    const bool feetech = model.protocol == servo_bus::Protocol::feetech;
    const auto read = load_motor_file(
        std::string("sim/robots/") + (feetech ? "so101" : "mini") + "/motor.xml", "");
    EXPECT_TRUE(read) << read.error().message;
    return read ? *read : MotorParams{};
  }
  void power_cycle() {
    servo->set_power(false, reading());
    servo->set_power(true, reading());
  }
  ServoReading reading() const {
    return {zero + angle * steps_per_rad(), speed * steps_per_rad(), motor.motor_current(),
            motor.case_celsius(), volts};
  }
  // Runs for `seconds` in steps of 1 ms. Each step solves I (w1 - w0) / h = T + load for the speed w1. Within
  // the bounds of the motor's row, the motor's torque T satisfies w1 + softness * T = velocity.
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / kStep); ++i) {
      time += std::chrono::milliseconds(1);
      const auto row = motor.prepare(servo->step(reading(), kStep, time), volts, angle, speed);
      const double yields = clamped ? 0 : kStep / inertia;
      const double free = clamped ? 0 : speed + yields * load_nm;
      const auto with_friction = [&](double friction) {
        const double start = free - yields * friction;
        return std::clamp((row.velocity - start) / (row.softness + yields), row.min, row.max);
      };
      // Friction opposes the motion that there would be without it, and does not reverse it.
      const double ahead = free + yields * with_friction(0);
      const double friction = std::copysign(row.friction, ahead);
      double torque = with_friction(friction) - friction;
      speed = free + yields * torque;
      if (row.friction > 0 && speed * ahead <= 0) {
        speed = 0;
        torque = yields > 0 ? -free / yields : std::clamp(with_friction(0), row.min, row.max);
      }
      angle += kStep * speed;
      motor.finish(speed, torque, clamped ? -torque : load_nm);
      fastest = std::max(fastest, std::abs(speed));
      highest = std::max(highest, get("present_position"));
    }
  }
  int get(const std::string& name) const { return servo->registers().get(name); }
  // Sends a request packet that writes a register, and returns the answer.
  std::optional<VirtualServo::Answer> set(const std::string& name, int value) {
    return send(write_request(servo->registers().model(), 1, name, value));
  }
  std::optional<VirtualServo::Answer> send(const Bytes& wire) {
    std::optional<VirtualServo::Answer> answer;
    for (const auto byte : wire) {
      if (auto one = servo->take(byte, time)) answer = std::move(one);
    }
    return answer;
  }
  std::optional<VirtualServo::Answer> send(const feetech::Packet& packet) {
    return send(feetech::wire_of(packet));
  }
  double steps_per_rad() const { return servo->registers().model().steps_per_rad(); }

  static constexpr double kStep = 1e-3;
  std::unique_ptr<VirtualServo> servo;
  JointMotor motor;
  double inertia, zero;
  double angle = 0, speed = 0, load_nm = 0, volts;
  bool clamped = false;  // true if a rigid clamp holds the shaft
  double fastest = 0;    // largest speed so far, rad/s
  int highest = 0;       // largest present_position so far
  Time time{};
};

}  // namespace kaz::sim::test
