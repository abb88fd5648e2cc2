// Cases for a servo on a bus: does it do what its maker publishes? And how they are run.
// SPDX-License-Identifier: Apache-2.0
//
// Sources are docs/reference/servo-bus.md and dynamixel-bus.md without what is "chosen" there, and the corpus
// of registers. A case changes only registers that it puts back.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/bus/examined_servo.h"
#include "hil/conformance/suite.h"
#include "host/link/interrupt.h"

namespace kaz::hil {

// What a case needs besides a servo that answers.
enum ServoNeed : unsigned {
  kServoNothing = 0,
  kServoMotion = 1,  // the torque is on, the shaft turns
  kServoEeprom = 2,  // writes EEPROM, whose life is finite
  kServoAlone = 4,   // requests to all servos at the port
  kServoNever = 8,   // what cannot be put back
  kServoModel = 16,  // another model or firmware; run_bus_suite() knows
};

struct ServoCase {
  Case of;  // id, sentence, the pages' sections; without its own `run`
  unsigned needs = kServoNothing;
  std::function<void(ExaminedServo&)> run;
  // Whether a servo of this table and firmware has what is examined; null: all have.
  std::function<bool(const ServoTable&, int firmware)> has;
};

// In the order in which they run.
const std::vector<ServoCase>& servo_cases(ServoFamily family);
// Those that the filter takes. Error: usage, if it is no regular expression or takes none.
Result<std::vector<const ServoCase*>> chosen(ServoFamily family, const std::string& filter);
std::string missing_servo_text(unsigned missing);

struct BusRunOptions {
  ServoFamily family = ServoFamily::feetech;
  int id = 1;
  std::string filter;
  unsigned allowed = 0;  // ServoNeed
  bool release = false;  // a torque that is on is switched off at the beginning
  // May be null. Once requested, what the case has changed is put back, and the run ends.
  host::Interrupt* interrupt = nullptr;
  host::LatenessMeter* lateness = nullptr;
  std::function<void(const CaseResult&, std::size_t number, std::size_t of)> progress;
};

// Errors (environment): as of ExaminedServo::identify(); the port is gone; registers that an interrupted case
// has changed could not be put back.
Result<RunReport> run_bus_suite(host::Link& link, host::Clock& clock, const BusRunOptions& options);

void add_feetech_cases(std::vector<ServoCase>& all);
void add_dynamixel_cases(std::vector<ServoCase>& all);

// What the cases of both families have in common.
struct ServoCases {
  std::vector<ServoCase>& all;
  std::string page;
  void add(std::string id, std::string sentence, std::string section,
           std::function<void(ExaminedServo&)> run, unsigned needs = kServoNothing,
           std::function<bool(const ServoTable&, int)> has = nullptr) {
    all.push_back({{std::move(id), std::move(sentence), {page + "#" + section}, 0, nullptr},
                   needs,
                   std::move(run),
                   std::move(has)});
  }
};
void add_register_cases(ServoCases cases, ServoFamily family);
void add_motion_cases(ServoCases cases, ServoFamily family);
// `row`: of a servo, RAM that moves nothing while the torque is off.
void add_write_to_all(ServoCases cases, ServoFamily family,
                      const ServoRow& (*row)(const ExaminedServo&));

}  // namespace kaz::hil
