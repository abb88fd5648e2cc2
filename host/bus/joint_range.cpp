// The range of a joint, and where it has to lie.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/joint_range.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace kaz::host {
namespace {

using servo_bus::BusServo;
using servo_bus::Model;
using servo_bus::Protocol;

constexpr double kDegree = std::numbers::pi / 180;
// Steps by which stops give way: limits that cut off less are left alone.
constexpr double kGives = 20;
constexpr double kShare = 0.1, kLeast = 10 * kDegree;  // by which a range may differ

double modulo(double value, double turn) {
  return value - turn * std::floor(value / turn);
}

// Degrees, for people.
std::string degrees(double steps, const Model& model) {
  char text[40];
  std::snprintf(text, sizeof text, "%.0f degrees", steps / model.steps_per_rad() / kDegree);
  return text;
}

// By how much the horn has to be turned for the middle of the range to come to that of the sensor.
std::string remount(double middle, const Model& model) {
  return "take the horn off, turn the shaft by about " +
         degrees(std::abs(model.steps / 2.0 - middle), model) + " toward " +
         (middle < model.steps / 2.0 ? "higher" : "lower") + " positions, and put the horn back";
}

bool has_offset(const Model& model) {
  return model.find("position_offset") != nullptr;
}

}  // namespace

RangeSweep::RangeSweep(const Model& model)
    : turn_(model.full_turn && model.protocol == Protocol::feetech ? model.steps : 0),
      quarter_(model.steps * (std::numbers::pi / 2) / model.span_rad) {}

void RangeSweep::add(double position) {
  if (readings_++ == 0) {
    last_ = now_ = low_ = high_ = position;
    return;
  }
  double change = position - last_;
  if (turn_ > 0) change -= turn_ * std::round(change / turn_);
  last_ = position;
  jumped_ = jumped_ || std::abs(change) > quarter_;
  now_ += change;
  low_ = std::min(low_, now_);
  high_ = std::max(high_, now_);
}

double range_share(const BusServo& servo, double lower_rad, double upper_rad,
                   const RangeSweep& sweep) {
  const double wanted = (upper_rad - lower_rad) * servo.model->steps_per_rad();
  return wanted > 0 ? std::min(1.0, sweep.width() / wanted) : 1;
}

RangePlan plan_range(const BusServo& servo, double lower_rad, double upper_rad,
                     const RangeRegisters& now, const RangeSweep& sweep) {
  const Model& model = *servo.model;
  const double turn = model.steps, per_rad = model.steps_per_rad();
  RangePlan plan;
  plan.registers = now;
  const auto fault = [&plan](std::string text) {
    plan.fault = std::move(text);
    return plan;
  };
  if (sweep.empty()) return fault("the servo was not read: check its cable");
  if (now.counts_turns)
    return fault(
        "the servo counts turns, but loses this count at power-off: clear bit 4 of its register "
        "`phase`, so that positions stay within one turn");
  if (sweep.jumped())
    return fault("the readings jumped by more than a quarter of a turn: turn the joint slowly");
  const double wanted = (upper_rad - lower_rad) * per_rad;
  if (std::abs(sweep.width() - wanted) > std::max(kShare * wanted, kLeast * per_rad))
    return fault(
        "the joint was turned through " + degrees(sweep.width(), model) +
        ", but its range in the robot file is " + degrees(wanted, model) +
        ": turn the joint from one stop to the other, or correct its limits in the robot file");

  // Positions at the stops afterwards: those read, shifted by `shift`.
  const double middle = (sweep.low() + sweep.high()) / 2;
  double shift = 0;
  if (model.protocol == Protocol::dynamixel) {
    const double encoder_low = sweep.low() - now.offset, encoder_high = sweep.high() - now.offset;
    const double turns = turn * std::floor(encoder_low / turn);
    plan.wrapped = std::floor(encoder_high / turn) != std::floor(encoder_low / turn);
    if (plan.wrapped)
      return fault(
          "inside the joint's range, the servo's position jumps from its highest to its lowest "
          "value, and no register can move this jump out of the range: " +
          remount(modulo((encoder_low + encoder_high) / 2, turn), model));
    shift = -turns;  // forgotten when the torque comes
    if (sweep.low() + shift < 0 || sweep.high() + shift > turn - 1) {
      // Goals of the position mode are within one turn.
      plan.registers.offset = 0;
      shift -= now.offset;
    }
  } else if (has_offset(model)) {
    const double low = modulo(sweep.low(), turn);
    shift = low - sweep.low();
    plan.wrapped = sweep.high() + shift > turn - 1;
    if (sweep.width() > turn - 2 * kRangeMargin)
      return fault("the joint was turned through " + degrees(sweep.width(), model) +
                   ": this range must be clearly smaller than one full turn, because the servo's "
                   "positions repeat after each turn");
    if (low < kRangeMargin || sweep.high() + shift > turn - 1 - kRangeMargin) {
      // The middle of the range to the middle of the turn. The register holds half a turn either way.
      const double encoder = modulo(middle + now.offset, turn);
      plan.registers.offset =
          static_cast<int>(std::clamp(std::round(encoder - turn / 2), 1 - turn / 2, turn / 2 - 1));
      shift = modulo(encoder - plan.registers.offset, turn) - middle;
    }
  } else if (sweep.low() < 2 || sweep.high() > turn - 3) {
    return fault("the joint's range exceeds the range of the servo's sensor: " +
                 remount(middle, model));
  }
  plan.low = sweep.low() + shift;
  plan.high = sweep.high() + shift;
  const bool none = now.low == 0 && now.high == 0 && model.protocol == Protocol::feetech;
  const bool moved = plan.registers.offset != now.offset;
  if (!none && (moved || now.low > plan.low + kGives || now.high < plan.high - kGives)) {
    plan.registers.low = static_cast<int>(std::max(0.0, std::floor(plan.low)));
    plan.registers.high = static_cast<int>(std::min(turn - 1, std::ceil(plan.high)));
  }
  plan.zero = std::round(middle + shift - servo.sign() * (lower_rad + upper_rad) / 2 * per_rad);
  return plan;
}

}  // namespace kaz::host
