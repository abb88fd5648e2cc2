// The range of a joint that somebody turns by hand, and where it has to lie for its servo's position not to
// wrap.
// SPDX-License-Identifier: Apache-2.0
//
// A servo's position is its encoder's, shifted by a register, and within one turn. Where the end of the turn
// lies inside of the joint's range, the position jumps from 4095 to 0 on the way, and a position loop goes
// back the long way.
//   STS:        position = (encoder - position_offset) mod 4096: the offset moves the end of the turn
//   DYNAMIXEL:  position = encoder + homing_offset, in mode 3: the end stays at the encoder's 0
//   SCS:        no offset; the sensor ends at 0 and 1023
// Sources: docs/reference/servo-bus.md, dynamixel-bus.md.
#pragma once

#include <string>

#include "shared/servo_bus/bus_file.h"

namespace kaz::host {

// Readings of one joint's position, counted over the ends of turns.
class RangeSweep {
 public:
  explicit RangeSweep(const servo_bus::Model& model);
  void add(double position);

  bool empty() const { return readings_ == 0; }
  double now() const { return now_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double width() const { return high_ - low_; }
  // Two readings in a row were more than a quarter of a turn apart: what is between them is not known.
  bool jumped() const { return jumped_; }

 private:
  double turn_;  // steps; 0: its position does not wrap, or is counted by the servo
  double quarter_;
  double last_ = 0, now_ = 0, low_ = 0, high_ = 0;
  int readings_ = 0;
  bool jumped_ = false;
};

// What the servo's EEPROM has to say of its position.
struct RangeRegisters {
  int offset = 0;             // position_offset, homing_offset; 0 where there is none
  int low = 0, high = 0;      // limits of goals
  bool counts_turns = false;  // STS: bit 4 of phase
  bool operator==(const RangeRegisters&) const = default;
};

struct RangePlan {
  std::string fault;         // why the joint is not calibrated, and what to do; empty: it is
  bool wrapped = false;      // the end of a turn was inside of the range
  double low = 0, high = 0;  // positions at the stops afterwards, steps
  RangeRegisters registers;  // afterwards
  double zero = 0;           // of bus.json
};

// Steps between the range and the end of a turn.
inline constexpr double kRangeMargin = 40;

// Share of the range that the joint has by its robot file, 0..1.
double range_share(const servo_bus::BusServo& servo, double lower_rad, double upper_rad,
                   const RangeSweep& sweep);

// The stops are those of the robot file, lower_rad and upper_rad: the middle of one range is that of the
// other. A sweep that is narrower or wider by 10 % and 10 degrees is a fault.
RangePlan plan_range(const servo_bus::BusServo& servo, double lower_rad, double upper_rad,
                     const RangeRegisters& now, const RangeSweep& sweep);

}  // namespace kaz::host
