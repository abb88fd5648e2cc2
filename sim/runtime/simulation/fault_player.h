// Applies faults of sensors, power and mechanics to the board and the world, step by step.
// SPDX-License-Identifier: Apache-2.0
//
// A fault is reported in the step that contains the start of the fault. The fault `power_reset` takes effect
// in the step in which the fault is reported. A fault of any kind except `power_reset` takes effect in each
// step that begins between the start and the end of the fault. SerialLine applies faults of the serial line,
// byte by byte.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "shared/faults/faults.h"
#include "sim/board/servo_board.h"
#include "sim/body/world/world.h"

namespace kaz::sim {

class FaultPlayer {
 public:
  explicit FaultPlayer(faults::Schedule schedule) : schedule_(std::move(schedule)) {}
  const faults::Schedule& schedule() const { return schedule_; }
  void add(const faults::Fault& fault) { schedule_.add(fault); }
  void clear();

  // Applies faults of potentiometers and power. Call this function before the board runs the step that begins
  // at `start`. Calls `begins` once for each fault, in the step that contains the start of the fault.
  void begin_step(Time start, ServoBoard& board,
                  const std::function<void(const faults::Fault&)>& begins);
  // Applies faults of joints and motors. `drives` are the motor drives of the step that begins at `start`.
  void apply(Time start, std::span<MotorDrive, KZ_JOINTS> drives) const;

  // Saves or restores the complete state (archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(schedule_, begun_, touched_, cut_);
  }

 private:
  void set_pots(Time start, ServoBoard& board);
  void set_power(Time start, ServoBoard& board);

  faults::Schedule schedule_;
  std::vector<bool> begun_;  // whether each fault was reported; same indices as the schedule
  // True: the schedule contained faults in the previous step. If the schedule is empty now, this step removes
  // the effects of the earlier faults.
  bool touched_ = false;
  bool cut_ = false;  // true: a fault has switched the power off
};

}  // namespace kaz::sim
