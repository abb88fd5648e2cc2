// The motion of a virtual servo of Feetech's.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/feetech_motion.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {
namespace {

// Duty per rad and unit of P, and the highest duty (Rhoban/bam, feetech_sts3215: oscilloscope).
constexpr double kDutyPerRad = 0.166, kMaxDuty = 0.97;
// Chosen. I: duty per rad s and unit, the scale of P. Speed loop: duty per rad/s, and per rad, and unit; an
// unloaded STS3215 then follows a step within 0.2 s without overshoot.
constexpr double kDutyPerRadSecond = 0.166;
constexpr double kSpeedDutyPerRadPerS = 0.02, kSpeedDutyPerRad = 0.2;
constexpr int kDutySign = 1 << 10;  // SCS: of goal_time in duty mode
constexpr int kFineSpeed = 4;       // bit of `phase`

// Magnitude raised to `least`, where it is not 0.
double at_least(double value, double least) {
  return value == 0 ? 0 : std::copysign(std::max(std::abs(value), least), value);
}

}  // namespace

FeetechMotion::Mode FeetechMotion::mode_of(const RegisterFile& registers) const {
  if (registers.has("mode")) return static_cast<Mode>(registers.get("mode"));
  const bool free = registers.get("min_angle") == 0 && registers.get("max_angle") == 0;
  return free ? Mode::duty : Mode::position;
}

std::string_view FeetechMotion::goal_register(const RegisterFile& registers) const {
  switch (mode_of(registers)) {
    case Mode::speed:
      return "goal_speed";
    case Mode::duty:
      return "goal_time";
    default:
      return "goal_position";
  }
}

double FeetechMotion::speed_unit(const RegisterFile& registers) {
  const bool coarse = registers.has("speed_unit") && (registers.get("phase") & kFineSpeed) == 0;
  return coarse ? registers.get("speed_unit") : 1;
}

int FeetechMotion::position(const RegisterFile& registers) const {
  const servo_bus::Model& model = registers.model();
  const double counted = std::round(steps_);
  if (!model.full_turn) return static_cast<int>(std::clamp(counted, 0.0, model.steps - 1.0));
  const int offset = registers.get("position_offset");
  const bool several_turns = (registers.get("phase") & 16) != 0;
  if (several_turns)
    return static_cast<int>(std::clamp(counted - turns_origin_ - offset, -32766.0, 32766.0));
  const int wrapped = static_cast<int>(std::fmod(counted - offset, model.steps));
  return wrapped < 0 ? wrapped + model.steps : wrapped;
}

void FeetechMotion::power_on(const ServoReading& reading) {
  auto law = std::move(law_);
  *this = {};
  law_ = std::move(law);
  if (law_) law_->power_on();
  steps_ = reading.steps;
}

void FeetechMotion::reset_turns(const servo_bus::Model& model) {
  turns_origin_ = std::floor(std::round(steps_) / model.steps) * model.steps;
}

void FeetechMotion::goal_written(const RegisterFile& registers) {
  timed_speed_ = 0;
  if (mode_of(registers) == Mode::steps)
    steps_goal_ = (goal_known_ ? steps_goal_ : std::round(steps_)) + registers.get("goal_position");
  goal_known_ = true;
  // SCS: the profile's speed is such that the motion takes goal_time.
  const int ms = registers.has("mode") ? 0 : registers.get("goal_time");
  if (ms > 0) timed_speed_ = std::abs(goal(registers) - trajectory_.position) / (1e-3 * ms);
}

void FeetechMotion::set_position(RegisterFile& registers, int position) {
  const int steps = registers.model().steps;
  const int encoder = static_cast<int>(std::fmod(std::round(steps_), steps));
  // The shortest offset that does it; the register holds half a turn either way.
  int offset = (encoder - position) % steps;
  if (offset > steps / 2 - 1) offset -= steps;
  if (offset < -(steps / 2 - 1)) offset += steps;
  registers.set("position_offset", std::clamp(offset, 1 - steps / 2, steps / 2 - 1));
  registers.keep("position_offset");
  hold(registers, this->position(registers));
}

double FeetechMotion::goal(const RegisterFile& registers) const {
  const double wanted = registers.get("goal_position");
  const int low = registers.get("min_angle"), high = registers.get("max_angle");
  if (low == 0 && high == 0) return wanted;
  return std::clamp<double>(wanted, std::min(low, high), std::max(low, high));
}

void FeetechMotion::hold(const RegisterFile& registers, double position) {
  trajectory_.hold(position);
  if (law_) law_->hold(position / registers.model().steps_per_rad());
  target_ = position;
  moving_ = false;
  integral_ = 0;
  errors_.fill(0);
}

void FeetechMotion::follow_profile(const RegisterFile& registers, double goal, double step_s) {
  const double unit = registers.get("speed_unit");
  const double highest = registers.has("max_speed") ? unit * registers.get("max_speed") : INFINITY;
  double speed = std::abs(registers.get("goal_speed")) * speed_unit(registers);
  if (speed == 0) {
    const bool zero_is_highest = !registers.has("max_speed") || (registers.get("phase") & 8) != 0;
    speed = zero_is_highest ? highest : 0;
  }
  if (timed_speed_ > 0) speed = timed_speed_;
  speed = std::min(speed, highest);
  const int acceleration = registers.get("acceleration");
  const int highest_rate = registers.get("max_acceleration");
  const int rate = highest_rate > 0 ? std::min(acceleration, highest_rate) : acceleration;
  // An identified servo has its own limit of the speed.
  if (law_ && acceleration == 0 && speed == highest)
    trajectory_.hold(goal);
  else
    trajectory_.go_to(goal, speed, 100.0 * rate, step_s);
  target_ = trajectory_.position;
  moving_ = trajectory_.speed != 0;
}

double FeetechMotion::position_loop(const RegisterFile& registers, const ServoReading& reading,
                                    double position, double most, double step_s) {
  const double per_rad = registers.model().steps_per_rad();
  if (law_) target_ = law_->setpoint_rad() * per_rad;
  double error = target_ - position;
  if (error <= registers.get("dead_zone_ccw") && error >= -registers.get("dead_zone_cw")) error = 0;
  const double rad = error / per_rad;
  ++newest_;
  errors_[newest_] = rad;
  const auto interval = static_cast<std::uint8_t>(registers.get("derivative_time", 20));
  const double change = rad - errors_[static_cast<std::uint8_t>(newest_ - interval)];
  const double i = kDutyPerRadSecond * registers.get("position_i");
  integral_ = i > 0 ? std::clamp(integral_ + rad * step_s, -1 / i, 1 / i) : 0;
  if (law_) {
    const double d = error == 0 ? 0 : kDutyPerRad * registers.get("position_d") * change;
    const double before = law_->setpoint_rad();
    const double halfway = (position + 0.5 * step_s * reading.speed) / per_rad;
    const double duty = law_->duty({.goal_rad = trajectory_.position / per_rad,
                                    .gain_per_rad = kLoggedDutyPerRad * registers.get("position_p"),
                                    .most_duty = most,
                                    .more_duty = d + i * integral_},
                                   error == 0 ? before : halfway, step_s);
    target_ = law_->setpoint_rad() * per_rad;
    moving_ = law_->setpoint_rad() != before;
    return duty;
  }
  const double duty =
      kDutyPerRad * (registers.get("position_p") * rad + registers.get("position_d") * change) +
      i * integral_;
  return error == 0 ? i * integral_ : at_least(duty, 1e-3 * registers.get("min_start_force"));
}

double FeetechMotion::speed_loop(const RegisterFile& registers, double speed, double step_s) {
  const double goal = registers.get("goal_speed") * speed_unit(registers);
  const int acceleration = registers.get("acceleration");
  trajectory_.reach_speed(goal, 100.0 * acceleration, step_s);
  const double error = (trajectory_.speed - speed) / registers.model().steps_per_rad();
  const double i = kSpeedDutyPerRad * registers.get("speed_i");
  integral_ = i > 0 ? std::clamp(integral_ + error * step_s, -1 / i, 1 / i) : 0;
  return kSpeedDutyPerRadPerS * registers.get("speed_p") * error + i * integral_;
}

MotorDrive FeetechMotion::step(RegisterFile& registers, const ServoReading& reading, double limit,
                               double step_s) {
  steps_ = reading.steps;
  const Mode mode = mode_of(registers);
  const bool torque_written = registers.get("torque_enable") == 1;
  if (!torque_written && torque_written_) goal_known_ = false;
  torque_written_ = torque_written;
  BusCommand command{registers.get("torque_enable"), goal(registers), goal_known_};
  if (law_) command = law_->delayed(command, step_s);
  const int now = position(registers);
  // Mode 3 counts on over the turn's end.
  const double place = mode == Mode::steps ? std::round(steps_) : now;
  duty_ = 0;
  if (command.torque != 1) {
    hold(registers, place);
    powered_ = false;
    report(registers, reading, now);
    return {.duty = 0, .powered = command.torque == 2};
  }
  const double most = std::min(
      {kMaxDuty, limit, 1e-3 * registers.get("torque_limit", registers.get("max_torque"))});
  if (!powered_) {
    hold(registers, place);
    if (!goal_known_) steps_goal_ = place;
  }
  powered_ = true;
  switch (mode) {
    case Mode::position:
      if (command.has_goal) follow_profile(registers, command.goal, step_s);
      duty_ = position_loop(registers, reading, place, most, step_s);
      break;
    case Mode::steps:
      follow_profile(registers, steps_goal_, step_s);
      duty_ = position_loop(registers, reading, place, most, step_s);
      break;
    case Mode::speed:
      trajectory_.position = target_ = place;
      if (law_) law_->hold(place / registers.model().steps_per_rad());
      duty_ = speed_loop(registers, reading.speed, step_s);
      moving_ = trajectory_.speed != 0;
      break;
    case Mode::duty: {
      hold(registers, place);
      const int raw = registers.get("goal_time");
      const bool negative = !registers.has("mode") && (raw & kDutySign) != 0;
      duty_ = 1e-3 * (negative ? -(raw & (kDutySign - 1)) : raw);
      break;
    }
  }
  duty_ = std::clamp(duty_, -most, most);
  report(registers, reading, now);
  return {.duty = duty_, .powered = true};
}

void FeetechMotion::report(RegisterFile& registers, const ServoReading& reading,
                           int position) const {
  registers.set("present_position", position);
  registers.set("present_speed",
                static_cast<int>(std::lround(reading.speed / speed_unit(registers))));
  registers.set("present_load", static_cast<int>(std::lround(1e3 * duty_)));
  registers.set("present_target", static_cast<int>(std::lround(target_)));
  const double threshold = registers.get("moving_threshold", 1) * registers.get("speed_unit", 20);
  registers.set("moving", moving_ || std::abs(reading.speed) > threshold ? 1 : 0);
}

}  // namespace kaz::sim
