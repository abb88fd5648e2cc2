// Conformance cases for bus servos, and how to run them.
// SPDX-License-Identifier: Apache-2.0
//
// The cases test the rules of docs/reference/servo-bus.md, but not the section "Our choices" of this page.
// The cases also compare the servo's registers with the corpus of registers in shared/*/corpus/*.csv. A case
// restores all registers that it changes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/bus/examined_servo.h"
#include "hil/conformance/suite.h"
#include "host/link/interrupt.h"

namespace kaz::hil {

// Requirements of a case, in addition to a servo that answers.
enum ServoNeed : unsigned {
  kServoNothing = 0,
  kServoMotion = 1,  // switches the torque on; the shaft turns
  kServoEeprom = 2,  // writes EEPROM, which wears out
  kServoAlone = 4,   // sends requests to all servos at the port
  kServoNever = 8,   // never run: the case would change a setting that cannot be restored
  kServoModel = 16,  // the case needs another model or firmware; set by run_bus_suite()
};

struct ServoCase {
  // General part of the case. In this part, the member `statements` lists the tested sections of
  // docs/reference/servo-bus.md. The member `run` of this part is null, because ServoCase::run is called
  // instead.
  Case of;
  unsigned needs = kServoNothing;
  std::function<void(ExaminedServo&)> run;
  // Returns whether servos with this table and firmware have the tested feature. Null: all servos have the
  // feature.
  std::function<bool(const ServoTable&, int firmware)> has;
};

// Returns all cases in the order in which they run.
const std::vector<ServoCase>& servo_cases(ServoFamily family);
// Returns the cases whose id or section matches the regular expression. Error (usage): the expression is
// invalid or matches no case.
Result<std::vector<const ServoCase*>> chosen(ServoFamily family, const std::string& filter);
// Returns the reason why a case is left out, such as "needs --allow-motion". `missing` contains the unmet
// requirements of the case, as ServoNeed bits.
std::string missing_servo_text(unsigned missing);

struct BusRunOptions {
  ServoFamily family = ServoFamily::feetech;
  int id = 1;
  std::string filter;
  unsigned allowed = 0;  // bits of ServoNeed that are allowed
  // Action if the torque is on at the start. True: run_bus_suite() switches the torque off. False:
  // run_bus_suite() returns an error.
  bool release = false;
  // After an interrupt, the registers that the running case changed are restored, and then the run ends.
  // `interrupt` may be null.
  host::Interrupt* interrupt = nullptr;
  host::LatenessMeter* lateness = nullptr;
  std::function<void(const CaseResult&, std::size_t number, std::size_t of)> progress;
};

// Runs the chosen cases. Returns the errors of chosen() and of ExaminedServo::identify(). Other errors
// (environment): the port is lost; registers of an interrupted case could not be restored. If the run was
// interrupted and all registers could be restored, returns the report of the cases that ran before the
// interrupt.
Result<RunReport> run_bus_suite(host::Link& link, host::Clock& clock, const BusRunOptions& options);

void add_feetech_cases(std::vector<ServoCase>& all);
void add_dynamixel_cases(std::vector<ServoCase>& all);

// List of the cases of one servo family. The functions below add cases that both families have in common.
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
// Adds a case that writes a RAM register of all servos with one request. `row` selects this register. Writing
// the register must not move the shaft while the torque is off.
void add_write_to_all(ServoCases cases, ServoFamily family,
                      const ServoRow& (*row)(const ExaminedServo&));

}  // namespace kaz::hil
