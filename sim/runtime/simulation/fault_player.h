// Faults of sensors, power and mechanics, made happen to board and world step by step.
// SPDX-License-Identifier: Apache-2.0
//
// A fault begins with the step in which its time lies, and ends with the first step after it;
// faults of
// the line are SerialLine's, byte by byte.
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

  // Before the board runs the step that begins at `start`. `begins` is told each fault that begins.
  void begin_step(faults::Time start, ServoBoard& board,
                  const std::function<void(const faults::Fault&)>& begins);
  // What the gears make of the motors' drives in the same step.
  void apply(faults::Time start, std::span<MotorDrive, KZ_JOINTS> drives) const;

  // All that it remembers (archive.h).
  template <class A>
  void transfer(A& a) {
    a(schedule_, begun_, touched_, cut_);
  }

 private:
  void set_pots(faults::Time start, ServoBoard& board);
  void set_power(faults::Time start, ServoBoard& board);

  faults::Schedule schedule_;
  std::vector<bool> begun_;  // of the schedule
  bool touched_ = false;     // the board has been given a fault that may have to be taken back
  bool cut_ = false;         // it was we who cut the power
};

}  // namespace kaz::sim
