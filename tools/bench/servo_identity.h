// The identified servo that a fit gives, and its comparison with a shipped servo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "shared/servo_model/servo_file.h"
#include "tools/bench/servo_report.h"

namespace kaz::tools {

// Returns the chosen model of a fit as an identified servo. `servo` is the model as in bus.json.
servo_model::IdentifiedServo identified_servo(const ServoResult& result, const std::string& servo);

// Returns a shipped servo, such as "sts3215-12v", or the servo of a file. A name with an extension is a path.
// Errors (usage): there is no such servo or file, or the file is invalid.
Result<servo_model::IdentifiedServo> named_servo(const std::string& name);

// Table and JSON of the differences between the servo `name` and an own servo.
std::string differences_text(const std::string& name,
                             const std::vector<servo_model::ServoDifference>& all);
nlohmann::ordered_json differences_json(const std::string& name,
                                        const std::vector<servo_model::ServoDifference>& all);

}  // namespace kaz::tools
