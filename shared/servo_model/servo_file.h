// Reads and writes the file of an identified servo: parameters with intervals, and their origin.
// SPDX-License-Identifier: Apache-2.0
//
// The file is JSON. `kaz bench servo` writes it, and motor.xml names it.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/servo_model/servo_model.h"

namespace kaz::servo_model {

struct IdentifiedParam {
  const ServoParamInfo* of = nullptr;  // never null
  double value = 0;
  // Uncertainty of the value, in the parameter's unit. Infinity: the logs do not determine the value.
  double within = std::numeric_limits<double>::infinity();
};

struct IdentifiedServo {
  std::string servo;  // model as in bus.json, such as "sts3215"
  double volts = 0;   // mean supply voltage of the logs
  int model = 1;      // friction model, 1 to 6
  // Each parameter of the model, in the order of servo_params().
  std::vector<IdentifiedParam> identified;
  std::string source, license, date;  // the date is YYYY-MM-DD
  std::string logs;                   // the logs that were used
  // Mean position errors, rad: of the model on held-out logs, and of repeated logs (repeatability). NaN:
  // unknown.
  double held_out_rad = std::numeric_limits<double>::quiet_NaN();
  double floor_rad = std::numeric_limits<double>::quiet_NaN();

  // All parameters. A parameter that the model lacks has its default.
  ServoParams params() const;
};

// Parses the text of a servo file. `path` appears in error messages only. Errors (usage): all wrong or
// missing keys, each with the path; the first is the message, the others are the details.
Result<IdentifiedServo> parse_servo_file(const std::string& path, const std::string& text);
// Reads and parses a servo file.
Result<IdentifiedServo> load_servo_file(const std::string& path);
// Names of the servos that Kaz ships (shared/servo_model/servos), separated by ", ".
std::string shipped_servo_names();
// Returns a servo that Kaz ships, such as "sts3215-12v". Errors (usage): there is no such servo.
Result<IdentifiedServo> shipped_servo(const std::string& name);
// Returns the text of a servo file. parse_servo_file() reads the same numbers from it.
std::string servo_file_text(const IdentifiedServo& servo);

// Difference of one parameter between two servos.
struct ServoDifference {
  std::string name, unit;
  // NaN: the model lacks the parameter.
  double shipped = 0, shipped_within = 0, own = 0, own_within = 0;
  // True if the two intervals do not overlap. False if one of them is infinite or one value is missing.
  bool differs = false;
};

// Compares the parameters of two servos, which may have different friction models.
std::vector<ServoDifference> differences(const IdentifiedServo& shipped,
                                         const IdentifiedServo& own);

}  // namespace kaz::servo_model
