// The motion of a virtual DYNAMIXEL.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/dynamixel_motion.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

constexpr double kFullPwm = 885;
constexpr int kSteps = 4096, kMostOffsetOfOneTurn = 1024;
// Registers' units: 0.229 rpm is 1/64 pulse/ms, 214.577 rpm² is 1/4096 pulse/ms².
constexpr double kVelocity = 1000.0 / 64, kAcceleration = 1e6 / 4096;
constexpr double kMs = 1e-3;
constexpr double kSlopeVoltsPerMs = 1.977e-3;
// Chosen: duty per A and ms, with which an XL330 and an XM430 reach a current within some ms.
constexpr double kDutyPerAmpere = 0.3;
// Chosen, pulses: arrived, and behind the profile.
constexpr double kArrived = 20, kLags = 100;
enum Shape { step_shape, rectangle, triangle, trapezoid };

double limited(double value, double most) {
  return std::clamp(value, -most, most);
}

}  // namespace

double DynamixelMotion::sign(const RegisterFile& registers) {
  return (registers.get("drive_mode") & 1) != 0 ? -1 : 1;
}

int DynamixelMotion::offset(const RegisterFile& registers) {
  const int offset = registers.get("homing_offset");
  const bool one_turn = registers.get("operating_mode") == position;
  return one_turn && std::abs(offset) > kMostOffsetOfOneTurn ? 0 : offset;
}

double DynamixelMotion::raw(const RegisterFile& registers) const {
  return sign(registers) * std::round(reading_.steps);
}

int DynamixelMotion::place(const RegisterFile& registers) const {
  return static_cast<int>(limited(raw(registers) - origin_ + offset(registers), 2e9));
}

void DynamixelMotion::wrap(const RegisterFile& registers) {
  origin_ = std::floor(raw(registers) / kSteps) * kSteps;
}

void DynamixelMotion::hold_law(const RegisterFile& registers) {
  if (law_) law_->hold(place(registers) / registers.model().steps_per_rad());
}

void DynamixelMotion::hold(RegisterFile& registers) {
  trajectory_.hold(place(registers));
  hold_law(registers);
  registers.set("goal_position", place(registers));
  profile_speed_ = profile_rate_ = 0;
  shape_ = step_shape;
  integral_ = 0;
}

void DynamixelMotion::power_on(RegisterFile& registers, const ServoReading& reading) {
  auto law = std::move(law_);
  *this = {};
  law_ = std::move(law);
  if (law_) law_->power_on();
  reading_ = reading;
  wrap(registers);
  registers.set("goal_pwm", registers.get("pwm_limit"));
  registers.set("goal_current", registers.get("current_limit"));
  hold(registers);
  report(registers);
}

void DynamixelMotion::mode_written(RegisterFile& registers) {
  registers.reset([](const servo_bus::Register& reg) {
    return reg.name.ends_with("_gain") || reg.name.starts_with("profile_") ||
           reg.name == "goal_velocity";
  });
  registers.set("goal_pwm", registers.get("pwm_limit"));
  registers.set("goal_current", registers.get("current_limit"));
  if (registers.get("operating_mode") == position) wrap(registers);
  hold(registers);
}

bool DynamixelMotion::clear_turns(RegisterFile& registers) {
  if (registers.get("moving") != 0) return false;
  wrap(registers);
  hold(registers);
  return true;
}

void DynamixelMotion::switch_on(RegisterFile& registers) {
  if (registers.get("operating_mode") == position) wrap(registers);
  hold(registers);
  pwm_ = 0;
  powered_ = true;
}

// Speed and rate with which the trajectory goes to the goal.
void DynamixelMotion::goal_written(const RegisterFile& registers) {
  if (!powered_) return;
  const bool by_time = (registers.get("drive_mode") & 4) != 0;
  const double speed = registers.get("profile_velocity"),
               rate = registers.get("profile_acceleration");
  if (registers.get("operating_mode") == velocity) {
    const double change = std::abs(kVelocity * registers.get("goal_velocity") - trajectory_.speed);
    profile_rate_ = rate == 0 ? 0 : by_time ? change / (kMs * rate) : kAcceleration * rate;
    return;
  }
  const double distance = std::abs(registers.get("goal_position") - trajectory_.position);
  if (by_time) {
    // Accelerates for `rate` ms, at most half of the `speed` ms that all takes.
    const double ramp = std::min(rate, speed / 2);
    profile_speed_ = speed == 0 ? 0 : distance / (kMs * (speed - ramp));
    profile_rate_ = ramp == 0 ? 0 : profile_speed_ / (kMs * ramp);
  } else {
    profile_speed_ = kVelocity * speed;
    profile_rate_ = speed == 0 ? 0 : kAcceleration * rate;
  }
  shape_ = profile_speed_ == 0                                          ? step_shape
           : profile_rate_ == 0                                         ? rectangle
           : distance < profile_speed_ * profile_speed_ / profile_rate_ ? triangle
                                                                        : trapezoid;
}

// All but the P gain is as in position_loop(); the P gain is that of the identified law.
double DynamixelMotion::law_loop(const RegisterFile& registers, double goal, double step_s) {
  const double per_rad = registers.model().steps_per_rad();
  const double p =
      static_cast<double>(registers.get("position_p_gain")) / registers.model().position_p_unit;
  const double more =
      position_loop(registers, goal, step_s) - p * (trajectory_.position - place(registers));
  const double halfway = place(registers) + 0.5 * step_s * sign(registers) * reading_.speed;
  return kFullPwm * law_->duty({.goal_rad = trajectory_.position / per_rad,
                                .gain_per_rad = p * per_rad / kFullPwm,
                                .most_duty = std::abs(registers.get("goal_pwm")) / kFullPwm,
                                .more_duty = more / kFullPwm},
                               halfway / per_rad, step_s);
}

double DynamixelMotion::position_loop(const RegisterFile& registers, double goal, double step_s) {
  if (profile_speed_ == 0) {
    trajectory_.hold(goal);
  } else {
    trajectory_.go_to(goal, profile_speed_, profile_rate_, step_s);
  }
  const double error = trajectory_.position - place(registers);
  const double change = kMs * (trajectory_.speed - sign(registers) * reading_.speed);
  const double i = registers.get("position_i_gain") / 65536.0;
  integral_ = i == 0 ? 0 : limited(integral_ + i * error * step_s / kMs, kFullPwm);
  return registers.get("position_p_gain") * error / registers.model().position_p_unit + integral_ +
         registers.get("position_d_gain") / 16.0 * change +
         registers.get("feedforward_1st_gain") / 4.0 * kMs * trajectory_.speed +
         registers.get("feedforward_2nd_gain") / 4.0 * kMs * kMs * trajectory_.acceleration;
}

double DynamixelMotion::velocity_loop(const RegisterFile& registers, double step_s) {
  trajectory_.reach_speed(kVelocity * registers.get("goal_velocity"), profile_rate_, step_s);
  trajectory_.position = place(registers);
  const double error = (trajectory_.speed - sign(registers) * reading_.speed) / kVelocity;
  const double i = registers.get("velocity_i_gain") / 65536.0;
  integral_ = i == 0 ? 0 : limited(integral_ + i * error * step_s / kMs, kFullPwm);
  return registers.get("velocity_p_gain") / 128.0 * error + integral_;
}

MotorDrive DynamixelMotion::step(RegisterFile& registers, const ServoReading& reading,
                                 double step_s, bool stopped) {
  reading_ = reading;
  const int mode = registers.get("operating_mode");
  BusCommand command{registers.get("torque_enable"),
                     static_cast<double>(registers.get("goal_position")), true};
  if (law_) command = law_->delayed(command, step_s);
  if (command.torque == 0) {
    powered_ = powered_ && registers.get("torque_enable") != 0;  // false before a late switch-on
    pwm_ = duty_ = 0;
    trajectory_.hold(place(registers));
    hold_law(registers);
    report(registers);
    return {.duty = 0, .powered = false};
  }
  if (stopped) {
    if (mode == velocity || mode == current || mode == pwm) {
      trajectory_.hold(place(registers));
      integral_ = 0;
    } else if (trajectory_.speed != 0) {
      hold(registers);
    }
  }

  const double amperes = sign(registers) * reading.current_a;
  const double most_current = registers.get("goal_current") * registers.model().current_unit_a;
  const auto current_loop = [&](double wanted) {
    return pwm_ + kFullPwm * kDutyPerAmpere * (wanted - amperes) * step_s / kMs;
  };
  const double before = pwm_;
  if (mode != position && mode != turns) hold_law(registers);
  switch (mode) {
    case current:
      pwm_ = stopped ? 0 : current_loop(most_current);
      break;
    case velocity:
      pwm_ = stopped ? 0 : velocity_loop(registers, step_s);
      break;
    case current_position: {
      const double all = registers.get("current_limit") * registers.model().current_unit_a;
      const double wanted = position_loop(registers, command.goal, step_s) / kFullPwm * all;
      pwm_ = current_loop(limited(wanted, std::abs(most_current)));
      break;
    }
    case pwm:
      trajectory_.hold(place(registers));
      pwm_ = stopped ? 0 : registers.get("goal_pwm");
      break;
    default:
      pwm_ = law_ ? law_loop(registers, command.goal, step_s)
                  : position_loop(registers, command.goal, step_s);
  }
  const double most = std::min<double>(std::abs(registers.get("goal_pwm")), kFullPwm);
  pwm_ = limited(pwm_, most);
  if (registers.has("pwm_slope") && reading.supply_volts > 0) {
    const double slope = registers.get("pwm_slope") * kSlopeVoltsPerMs / reading.supply_volts *
                         kFullPwm * step_s / kMs;
    pwm_ = std::clamp(pwm_, before - slope, before + slope);
  }
  duty_ = sign(registers) * pwm_ / kFullPwm;
  report(registers);
  return {.duty = duty_, .powered = true};
}

void DynamixelMotion::report(RegisterFile& registers) const {
  const auto set = [&registers](const char* name, double value) {
    registers.set(name, static_cast<int>(std::lround(value)));
  };
  const int now = place(registers), mode = registers.get("operating_mode");
  const double speed = sign(registers) * reading_.speed / kVelocity;
  set("present_position", now);
  set("present_velocity", speed);
  set("present_pwm", pwm_);
  set("position_trajectory", trajectory_.position);
  set("velocity_trajectory", trajectory_.speed / kVelocity);
  const bool positions = mode == position || mode == turns || mode == current_position;
  const bool runs = powered_ && positions && trajectory_.speed != 0;
  registers.set("moving", runs || std::abs(speed) > registers.get("moving_threshold") ? 1 : 0);
  int status = runs ? 2 : 0;
  if (positions) {
    status |= shape_ << 4;
    if (std::abs(now - registers.get("goal_position")) <= kArrived) status |= 1;
    if (std::abs(now - trajectory_.position) > kLags) status |= 8;
  }
  registers.set("moving_status", status);
}

}  // namespace kaz::sim
