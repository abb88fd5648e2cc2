// Injects faults of sensors, power and mechanics.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation/fault_player.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {

using faults::Fault;
using faults::Name;

void FaultPlayer::clear() {
  schedule_.clear();
  begun_.clear();
}

void FaultPlayer::begin_step(Time start, ServoBoard& board,
                             const std::function<void(const Fault&)>& begins) {
  if (schedule_.empty() && !touched_) return;
  set_pots(start, board);
  set_power(start, board);
  touched_ = !schedule_.empty();
  begun_.resize(schedule_.faults().size());
  for (std::size_t i = 0; i < begun_.size(); ++i) {
    const Fault& fault = schedule_.faults()[i];
    if (begun_[i] || fault.at >= start + std::chrono::milliseconds(1)) continue;
    begun_[i] = true;
    begins(fault);
    if (fault.name == Name::power_reset && board.power()) board.reset();
  }
}

void FaultPlayer::set_pots(Time start, ServoBoard& board) {
  std::array<PotFault, KZ_JOINTS> pots{};
  for (const Fault& fault : schedule_.faults()) {
    if (fault.joint < 0 || !fault.active(start)) continue;
    PotFault& pot = pots[static_cast<std::size_t>(fault.joint)];
    if (fault.name == Name::pot_open || fault.name == Name::pot_short) pot.level = fault.value;
    if (fault.name == Name::pot_noisy) pot.noise_codes = std::hypot(pot.noise_codes, fault.value);
    if (fault.name == Name::pot_stuck) pot.stuck = true;
  }
  for (int j = 0; j < KZ_JOINTS; ++j) board.set_pot_fault(j, pots[static_cast<std::size_t>(j)]);
}

void FaultPlayer::set_power(Time start, ServoBoard& board) {
  double change = 0;
  bool cut = false;
  for (const Fault& fault : schedule_.faults()) {
    if (!fault.active(start)) continue;
    if (fault.name == Name::power_sag) change -= fault.value;
    if (fault.name == Name::power_brown_out) cut = true;
  }
  board.set_supply_change(change);
  if (cut && board.power()) {
    board.set_power(false);
    cut_ = true;
  } else if (!cut && cut_) {
    board.set_power(true);
    cut_ = false;
  }
}

void FaultPlayer::apply(Time start, std::span<MotorDrive, KZ_JOINTS> drives) const {
  for (const Fault& fault : schedule_.faults()) {
    if (fault.joint < 0 || !fault.active(start)) continue;
    MotorDrive& drive = drives[static_cast<std::size_t>(fault.joint)];
    if (fault.name == Name::joint_stuck) drive.jammed = true;
    if (fault.name == Name::joint_reversed) drive.duty = -drive.duty;
    if (fault.name == Name::motor_weak) drive.duty *= fault.value;
    if (fault.name == Name::joint_slipping) drive.slip_nm = std::min(drive.slip_nm, fault.value);
  }
}

}  // namespace kaz::sim
