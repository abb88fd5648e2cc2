// Cases that move the servo: a few degrees to a goal, and back.
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "hil/bus/bus_suite.h"

namespace kaz::hil {
namespace {

constexpr Time kArrives = std::chrono::milliseconds(2500), kLook = std::chrono::milliseconds(50);

// Until the position is nearer to `goal` than two thirds of `way`: under an arm's weight it stays behind.
void wait_for(ExaminedServo& servo, const ServoRow& position, long goal, long way) {
  long now = 0;
  for (Time waited{}; waited < kArrives; waited += kLook) {
    servo.pause(kLook);
    now = servo.value(position);
    if (std::labs(now - goal) <= 2 * std::labs(way) / 3) return;
  }
  throw Failed{"goal " + std::to_string(goal) + " is not reached in 2.5 s: the position is " +
               std::to_string(now)};
}

}  // namespace

void add_motion_cases(ServoCases cases, ServoFamily family) {
  const bool feetech = family == ServoFamily::feetech;
  cases.add(
      "motion.goal", "The servo moves to a goal 11 degrees away, and back.", "motion",
      [feetech](ExaminedServo& servo) {
        const ServoTable& table = servo.table();
        const ServoRow& position =
            *table.find({"current location", "present position", "Present Position"});
        const ServoRow& goal = *table.find({"target location", "goal position", "Goal Position"});
        const ServoRow& torque = *table.find({"torque switch", "Torque Enable"});
        const ServoRow* mode = table.find({"operation mode", "Operating Mode"});
        if (mode != nullptr)
          equal(mode->what + " (position mode is needed)", servo.value(*mode), feetech ? 0 : 3);
        const long low = servo.value(
                       *table.find({"minimum angle limit", "minimum angle", "Min Position Limit"})),
                   high = servo.value(
                       *table.find({"maximum angle limit", "maximum angle", "Max Position Limit"}));
        const long start = servo.value(position);
        const long turn = table.big_endian() ? 1024 : 4096;
        long way = turn / 32;  // 11 degrees
        if (start + way > high) way = -way;
        check(start + way >= low && start + way <= high,
              "position " + std::to_string(start) + ": the limits " + std::to_string(low) + " to " +
                  std::to_string(high) +
                  " leave no room for a motion of 11 degrees; turn the shaft by hand toward the "
                  "middle");
        // Slowly: 30 degrees/s.
        if (feetech) {
          servo.write(*table.find({"operation speed", "goal speed"}), turn / 12);
        } else {
          servo.write(table.row("Profile Velocity"), 22);
          equal("error code when the torque is switched on", servo.write(torque, 1), 0);
        }
        for (const long to : {start + way, start}) {
          const auto got = servo.answer(3, servo.write_of(goal.address, encode(table, goal, to)));
          if (!feetech) equal("error code when a goal is written", got.error & 0x7F, 0);
          wait_for(servo, position, to, way);
        }
      },
      kServoMotion);
  if (feetech) return;
  cases.add(
      "motion.eeprom-is-locked", "EEPROM cannot be written while the torque is on.", "packet",
      [](ExaminedServo& servo) {
        const ServoTable& table = servo.table();
        equal("error code when the torque is switched on",
              servo.write(table.row("Torque Enable"), 1), 0);
        const ServoRow& row = table.row("Moving Threshold");
        // The value that it has: nothing changes if it is taken.
        const auto got =
            servo.answer(3, servo.write_of(row.address, encode(table, row, servo.value(row))));
        equal("error", got.error & 0x7F, 7);
      },
      kServoMotion);
}

}  // namespace kaz::hil
