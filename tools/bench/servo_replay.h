// Replays the goals of a servo's log on a virtual bus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/servo/servo_score.h"
#include "shared/servo_model/servo_file.h"

namespace kaz::tools {

// Writes the log's goals and torque switch as bytes to a virtual servo on the log's pendulum, at the times of
// the log. Returns the servo's measured position (rad) at each sample. D gain, I gain and minimum duty are 0,
// as during a recording, and a DYNAMIXEL does not shut down. `zero_rad` is the reading while the arm hangs
// straight down. Errors (usage): no model has the name `servo.servo`; the servo has no P gain for the log's
// gain.
Result<std::vector<double>> replay_log(const servo_model::IdentifiedServo& servo,
                                       const hil::ServoLog& log, double zero_rad);

// Mean position errors of one log, rad.
struct ReplayedLog {
  std::string name;
  double fit_rad = 0;       // error of the fit's prediction
  double replay_rad = 0;    // error of the virtual servo
  double distance_rad = 0;  // distance between virtual servo and prediction
};
// Replays each log with the fit's parameters and zeros. Errors: as replay_log(), with the log's name.
Result<std::vector<ReplayedLog>> replay_logs(const servo_model::IdentifiedServo& servo,
                                             const hil::ServoFit& fit,
                                             const std::vector<hil::ServoLog>& logs);

}  // namespace kaz::tools
