// Cases of both families: registers one by one, by the corpus.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hil/bus/bus_suite.h"

namespace kaz::hil {
namespace {

constexpr int kServoWrite = 3;  // of both families

// Rows that the cases of all RAM and EEPROM registers leave out, with the reason. Others of the same
// beginning, as "Goal PWM", alike.
constexpr std::pair<const char*, const char*> kNeverWritten[] = {
    {"ID", "a new value would make the servo unreachable"},
    {"baud rate", "a new value would make the servo unreachable"},
    {"Baud Rate", "a new value would make the servo unreachable"},
    {"Protocol Type", "a new value would make the servo unreachable"},
    {"Secondary ID", "with a new value, the servo would execute requests to another id"},
    {"return delay", "a new value would change the delay of each answer"},
    {"Return Delay Time", "a new value would change the delay of each answer"},
    {"response", "a new value could stop the answers to writes"},
    {"Status Return Level", "the case `instructions.status-return-level` writes this register"},
    {"lock", "while `lock` is 0, EEPROM keeps each written value"},
    {"phase", "the effect of some bits is unknown"},
    {"operation mode",
     "after a change of this register, the shaft could turn when the torque is switched on"},
    {"Operating Mode",
     "after a change of this register, the shaft could turn when the torque is switched on"},
    {"Drive Mode",
     "after a change of this register, the shaft could turn when the torque is switched on"},
    {"Startup Configuration",
     "after a change of this register, the shaft could turn at the next power-on"},
    {"position correction",
     "after a change of this register, the same goal would turn the shaft to a different position"},
    {"Homing Offset",
     "after a change of this register, the same goal would turn the shaft to a different position"},
    {"torque switch", "if the torque were switched on, the servo would hold the shaft"},
    {"Torque Enable", "if the torque were switched on, the servo would hold the shaft"},
    {"Bus Watchdog", "after a timeout of this watchdog, the servo would reject goals"},
    {"target location", "a write would switch the torque on"},
    {"goal position", "a write would switch the torque on"},
    {"Goal", "a write can switch the torque on"},
    {"operation time or PWM", "in one operating mode, this register sets the motor's duty"},
    {"operation speed", "in one operating mode, this register sets the motor's speed"},
    {"goal time", "in one operating mode, this register sets the motor's duty"},
    {"Indirect Data", "a write would change the register to which `Indirect Data` is mapped"},
};

bool never_written(const ServoRow& row) {
  return std::ranges::any_of(kNeverWritten,
                             [&](const auto& one) { return row.what.starts_with(one.first); });
}

void fail_if_any(const std::vector<std::string>& wrong) {
  if (wrong.empty()) return;
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < wrong.size() && i < kMost; ++i)
    text += (i == 0 ? "" : "; ") + wrong[i];
  if (wrong.size() > kMost) text += "; and " + std::to_string(wrong.size() - kMost) + " more";
  throw Failed{text};
}

std::string name_of(const ServoRow& row) {
  return row.what + " (" + std::to_string(row.address) + ")";
}

// Collects what is wrong with each row instead of ending at the first.
template <class Each>
void for_rows(ExaminedServo& servo, Each each) {
  std::vector<std::string> wrong;
  int silent = 0;
  for (const ServoRow& row : servo.table().rows) {
    try {
      each(row);
      silent = 0;
    } catch (const Failed& failed) {
      wrong.push_back(name_of(row) + ": " + failed.message);
      if (++silent == 10) break;  // it does not answer any more, or nothing of this works
    }
  }
  fail_if_any(wrong);
}

void write_and_read(ExaminedServo& servo, const ServoRow& row, long value) {
  equal("error of writing " + std::to_string(value), servo.write(row, value), 0);
  equal("read after writing " + std::to_string(value), servo.value(row), value);
}

}  // namespace

void add_write_to_all(ServoCases cases, ServoFamily family,
                      const ServoRow& (*row)(const ExaminedServo&)) {
  cases.add(
      "instructions.write-to-all", "A write to id 254 is executed and not answered.", "packet",
      [family, row](ExaminedServo& servo) {
        const ServoRow& written = row(servo);
        servo.keep(written);
        const long value = servo.value(written) == 5 ? 6 : 5;
        const Bytes data = encode(servo.table(), written, value);
        servo.silent(
            servo_request(family, kAllServos, kServoWrite, servo.write_of(written.address, data)),
            "a write to id 254");
        equal(written.what, servo.value(written), value);
      },
      kServoAlone);
}

void add_register_cases(ServoCases cases, ServoFamily family) {
  cases.add("registers.readable", "Each register can be read with a separate request.", "registers",
            [](ExaminedServo& servo) {
              for_rows(servo, [&](const ServoRow& row) { (void)servo.value(row); });
            });
  cases.add("registers.in-range", "Each writable register has a value in its range.", "registers",
            [](ExaminedServo& servo) {
              for_rows(servo, [&](const ServoRow& row) {
                // An identifier of its own, or not initialised before the first goal.
                if (!row.writable || row.what.starts_with("Goal")) return;
                within("value", servo.value(row), row.min, row.max);
              });
            });
  cases.add("registers.block",
            "A read of several registers returns the same values as separate "
            "reads.",
            "registers", [](ExaminedServo& servo) {
              // EEPROM does not change by itself: rows that follow one another without a gap.
              std::vector<const ServoRow*> run;
              const auto compare = [&] {
                if (run.size() < 2) return;
                const int begin = run.front()->address;
                const Bytes all = servo.read(begin, run.back()->address + run.back()->size - begin);
                for (const ServoRow* row : run) {
                  const auto at = all.begin() + (row->address - begin);
                  equal(name_of(*row), decode(servo.table(), *row, Bytes(at, at + row->size)),
                        servo.value(*row));
                }
              };
              for (const ServoRow& row : servo.table().rows) {
                if (!row.eeprom) continue;
                if (!run.empty() && run.back()->address + run.back()->size != row.address) {
                  compare();
                  run.clear();
                }
                run.push_back(&row);
              }
              compare();
            });
  cases.add("registers.ram", "Each RAM register accepts the ends and the middle of its range.",
            "registers", [](ExaminedServo& servo) {
              for_rows(servo, [&](const ServoRow& row) {
                if (!row.writable || row.eeprom || never_written(row)) return;
                for (const long value : {row.max, row.min, row.min + (row.max - row.min) / 2})
                  write_and_read(servo, row, value);
              });
            });
  cases.add(
      "registers.ram-read-only", "A read-only register keeps its value.", "registers",
      [family](ExaminedServo& servo) {
        const ServoRow& row =
            *servo.table().find({"current voltage", "present voltage", "Present Input Voltage"});
        const auto got = servo.answer(
            kServoWrite, servo.write_of(row.address, Bytes(static_cast<std::size_t>(row.size))));
        if (family == ServoFamily::dynamixel) equal("error", got.error & 0x7F, 7);
        check(servo.value(row) != 0, name_of(row) + " was overwritten with 0");
      });
  cases.add(
      "registers.eeprom",
      "Each EEPROM register can be changed by 1, and then back to its old "
      "value.",
      "registers",
      [](ExaminedServo& servo) {
        for_rows(servo, [&](const ServoRow& row) {
          if (!row.writable || !row.eeprom || never_written(row)) return;
          const long now = servo.value(row);
          write_and_read(servo, row, now < row.max ? now + 1 : now - 1);
          write_and_read(servo, row, now);
        });
      },
      kServoEeprom);
  std::string list;
  for (const auto& [name, reason] : kNeverWritten)
    list += (list.empty() ? "" : "; ") + std::string(name) + ": " + reason;
  cases.add(
      "registers.others",
      "The cases `registers.ram` and `registers.eeprom` do not write these registers (" + list +
          ").",
      "registers", [](ExaminedServo&) {}, kServoNever);
}

}  // namespace kaz::hil
