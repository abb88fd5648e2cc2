// Measures the range of a joint that the user turns by hand. Plans servo settings that keep the servo's
// position from wrapping inside the joint's range.
// SPDX-License-Identifier: Apache-2.0
//
// A servo's position is its encoder reading within one turn, shifted by an offset that is stored in a
// register. At the end of the turn, the position jumps from 4095 to 0. If the joint passes the end of the
// turn, a position loop turns the joint back the long way.
//
//   STS:        position = (encoder - position_offset) mod 4096. The offset moves the end of the turn.
//   DYNAMIXEL:  position = encoder + homing_offset, in mode 3. The end stays at the encoder's 0.
//   SCS:        no offset. The sensor ends at 0 and 1023.
//
// Source: docs/reference/servo-bus.md.
#pragma once

#include <string>

#include "shared/servo_bus/bus_file.h"

namespace kaz::host {

// Collects the position readings of one joint, in steps. If a reading wraps at the end of a turn, the
// collected position continues without a jump.
class RangeSweep {
 public:
  explicit RangeSweep(const servo_bus::Model& model);
  void add(double position);

  bool empty() const { return readings_ == 0; }
  double now() const { return now_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double width() const { return high_ - low_; }
  // Returns true if two consecutive readings were more than a quarter turn apart. Readings so far apart do
  // not show in which direction the joint was turned.
  bool jumped() const { return jumped_; }

 private:
  double turn_;  // steps per turn; 0: the position does not wrap, or the servo counts turns
  double quarter_;
  double last_ = 0, now_ = 0, low_ = 0, high_ = 0;
  int readings_ = 0;
  bool jumped_ = false;
};

// Position registers in the servo's EEPROM.
struct RangeRegisters {
  int offset = 0;             // position_offset or homing_offset; 0 if the model has no offset
  int low = 0, high = 0;      // limits of the goal position
  bool counts_turns = false;  // STS: bit 4 of the register `phase`
  bool operator==(const RangeRegisters&) const = default;
};

struct RangePlan {
  // Reason why the joint cannot be calibrated, and the remedy; empty if calibration is possible.
  std::string fault;
  bool wrapped = false;      // with the old registers, the position wraps within the joint's range
  double low = 0, high = 0;  // positions at the stops in steps, with the new registers
  RangeRegisters registers;  // new values of the registers
  double zero = 0;           // position of the joint's zero in steps, for bus.json
};

// Minimum distance, in steps, from the joint's range to the place at which the servo's position wraps.
inline constexpr double kRangeMargin = 40;

// Returns the share (0..1) of the joint's range in the robot file that was swept so far.
double range_share(const servo_bus::BusServo& servo, double lower_rad, double upper_rad,
                   const RangeSweep& sweep);

// Plans registers and zero. `lower_rad` and `upper_rad` are the ends of the joint's range in the robot file.
// RangePlan::zero is chosen so that the middle of the swept range has the joint angle
// (lower_rad + upper_rad) / 2. Sets RangePlan::fault if the joint cannot be calibrated. For example, the
// width of the swept range may differ too much from the width of the range in the robot file. The permitted
// difference is 10 degrees or 10 % of the width in the robot file, whichever is larger.
RangePlan plan_range(const servo_bus::BusServo& servo, double lower_rad, double upper_rad,
                     const RangeRegisters& now, const RangeSweep& sweep);

}  // namespace kaz::host
